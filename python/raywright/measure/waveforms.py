"""Waveforms of pulses, and the peaks in them."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from .places import Floats

# Full width at half maximum of a normal distribution, in standard deviations.
_WIDTH = 2.0 * math.sqrt(2.0 * math.log(2.0))
# Least dip between two peaks, relative to the lower one. Two equal pulses, a full width at half maximum
# apart, have a dip of 1 / 17.
_DIP = 0.05
# Waveform samples per batch.
_TOGETHER = 1 << 22


def peaks(t: Floats, width: Floats, resolution: float) -> NDArray[np.int64]:
    """Return the peak of its beam's waveform that each ray belongs to.

    The waveform is a sum of normal distributions, one per ray, as wide as the pulse and the part of the beam
    that the ray stands for. Rays belong together as far as no dip lies between them.

    Parameters
    ----------
    t : (N, R) float64
        Ranges of the rays of each beam, in order; inf for a miss.
    width : (N, R) float64
        Spread of ranges within the part of each ray: a standard deviation.
    resolution : float
        The full width at half maximum of the pulse.

    Returns
    -------
    (N, R) int64
        From 0 on, in order; of misses as of the last that is met.
    """
    found = np.zeros(t.shape, np.int64)
    is_met = np.isfinite(t)
    last = np.where(is_met, t, -np.inf).max(axis=1)
    sigma = resolution / _WIDTH
    # Equal normal distributions within two deviations have one peak; so have wider ones.
    several = np.flatnonzero(last - t[:, 0] > 2.0 * sigma)
    step = max(_TOGETHER // (16 * t.shape[1] ** 2), 1)
    for start in range(0, len(several), step):
        some = several[start : start + step]
        met, wide = is_met[some], np.hypot(sigma, np.where(is_met[some], width[some], 0.0))
        found[some] = _of_several(np.where(met, t[some], last[some, None]), wide, met)
    return found


def _of_several(t: Floats, wide: Floats, is_met: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Return the peaks of rays as `peaks` does; misses stand at the last range that is met."""
    beam, place = _sampled(t, wide)
    height = np.empty(len(place))
    weight = is_met / wide
    step = max(_TOGETHER // t.shape[1], 1)
    for start in range(0, len(place), step):
        which, at = beam[start : start + step], place[start : start + step, None]
        height[start : start + step] = (
            weight[which] * np.exp(-0.5 * ((at - t[which]) / wide[which]) ** 2)
        ).sum(axis=1)
    counts = np.bincount(beam, minlength=len(t))
    column = np.arange(len(place)) - np.repeat(np.cumsum(counts) - counts, counts)
    heights, places = (np.zeros((len(t), counts.max())) for _ in range(2))
    heights[beam, column], places[beam, column] = height, place
    number = np.zeros(t.shape, np.int64)
    for valley in _valleys(heights, places):
        number += t >= valley[:, None]
    return number


def _sampled(t: Floats, wide: Floats) -> tuple[NDArray[np.int64], Floats]:
    """Return beams and ranges at which waveforms are looked at: at rays, and between those far apart."""
    gap = np.diff(t, axis=1, append=t[:, -1:])
    narrow = np.minimum(wide, np.roll(wide, -1, axis=1))
    # One sample per half deviation between two rays, at most eight. Rays within a quarter of one share a
    # sample.
    between = np.clip(np.ceil(gap / (0.5 * narrow)), 1, 8).astype(np.int64)
    bins = np.floor((t - t[:, :1]) / (0.25 * wide.min(axis=1, keepdims=True)))
    is_new = np.diff(bins, axis=1, prepend=-1.0) > 0
    counts = np.where(is_new | (between > 1), between, 0)
    flat = counts.reshape(-1)
    which = np.repeat(np.arange(t.size), flat)
    nth = np.arange(len(which)) - np.repeat(np.cumsum(flat) - flat, flat)
    place = t.reshape(-1)[which] + gap.reshape(-1)[which] * nth / flat[which]
    return which // t.shape[1], place


def _valleys(heights: Floats, places: Floats) -> list[Floats]:
    """Return where beams are lowest between two peaks, one after the other; inf where a beam has no more."""
    valleys = []
    peak, low = heights[:, 0].copy(), np.full(len(heights), np.inf)
    at = np.full(len(heights), np.inf)
    for height, place in zip(heights.T[1:], places.T[1:], strict=True):
        # A dip counts only if the waveform rises again behind it.
        is_next = (low < np.inf) & (low < (1.0 - _DIP) * height)
        if is_next.any():
            valleys.append(np.where(is_next, at, np.inf))
        peak = np.where(is_next, height, np.maximum(peak, np.where(low < np.inf, 0.0, height)))
        is_lower = ~is_next & (height < np.minimum(low, (1.0 - _DIP) * peak))
        at = np.where(is_next, np.inf, np.where(is_lower, place, at))
        low = np.where(is_next, np.inf, np.where(is_lower, height, low))
    return valleys
