"""Choice of the sampler if none is named, by the render's limits."""

from __future__ import annotations

from typing import TypeAlias

from .. import _core
from ..descriptions import changed
from ..scene.scene import Scene
from .plan import Choice, RenderPlan
from .samplers import Halton, Independent, Lattice, Sampler, Sobol, Stratified

Limits: TypeAlias = tuple[int | None, float | None, float | None]
"""Samples, error and seconds; None where there is no limit."""

_MOST = 64
# Samples in a batch if time may end a render after few samples: the error is reliable from two batches on.
_TIMED = 16
# The same if four parts of the samples are kept apart, each of whole batches.
_TIMED_APART = 4
# If an error may end a render: samples to a relMSE of 1, by the scenes of `benches/samplers.py`, and the
# least number of samples.
_EXPECTED = 0.25
_FEWEST = 16
# Rough number of samples that one or two cores take per second.
_RATE = 1e6
# If each sample has photons of its own, they cause most of the noise, and stratification cannot reduce it.
# With more batches, a pixel's error has fifteen degrees of freedom in place of three.
_PARTED = 4
# Lattices of up to this many points are badly distributed.
_FEW = 4


def expected(limits: Limits, pixels: int) -> float:
    """Return about how many samples of each pixel a render takes."""
    samples, error, seconds = limits
    options = []
    if samples is not None:
        options.append(float(samples))
    if error is not None:
        options.append(max(_EXPECTED / error, _FEWEST))
    if seconds is not None:
        options.append(seconds * _RATE / pixels)
    return min(options)


def chosen(
    sampler: Sampler | None,
    limits: Limits,
    adaptive: bool,
    begun: object = None,
    apart: bool = False,
    photons: bool = False,
) -> tuple[Sampler, RenderPlan]:
    """Return the sampler of a render, with its batches, and the plan with its row.

    Parameters
    ----------
    sampler : Sampler, optional
        The sampler named by the user, if any.
    limits : tuple
        Samples, error and seconds; None where there is no limit.
    adaptive : bool
        True if pixels are split into halves.
    begun : str, optional
        The ``repr`` of the sampler of a render that goes on.
    apart : bool
        True if four parts of the samples are kept apart.
    photons : bool
        True if each sample traces photons of its own.
    """
    if isinstance(sampler, Independent) or (sampler is not None and sampler.batch is not None):
        return _planned(sampler, "as named", "as named")
    if (before := _of(begun, sampler)) is not None:
        kind = "as the checkpoint has it" if sampler is None else "as named"
        return _planned(before, kind, "as the checkpoint has it")
    batch, why = _batch(limits, adaptive, apart)
    if photons:
        why = f"{why}; {_PARTED} times as many, for each sample has its photons"
        batch = max(batch // _PARTED, 1)
    if sampler is not None:
        return _planned(changed(sampler, batch=batch), "as named", why)
    if batch == 1:
        return _planned(Independent(), "a batch of one has nothing to place", why)
    if batch <= _FEW:
        return _planned(Sobol(batch), f"lattices of {_FEW} points lie on a diagonal", why)
    return _planned(Lattice(batch), f"the least error of all, in batches of more than {_FEW}", why)


def waves(scene: Scene) -> tuple[Choice, ...]:
    """Return the reason for spectral rendering, as a row of the plan; none if red, green and blue suffice."""
    why = scene.wavelengths
    return () if why is None else (Choice("wavelengths", "three a path", why),)


def _planned(sampler: Sampler, kind: str, batch: str) -> tuple[Sampler, RenderPlan]:
    rows = [Choice("sampler", type(sampler).__name__, kind)]
    if not isinstance(sampler, Independent):
        rows.append(Choice("batch", str(sampler.batch), batch))
    elif batch != "as named":
        rows.append(Choice("batch", "1", batch))
    return sampler, RenderPlan(tuple(rows), sampler)


def _of(begun: object, sampler: Sampler | None) -> Sampler | None:
    """Return the sampler that a ``repr`` is of, if it is one of those that are wanted."""
    if sampler is None and begun == repr(Independent()):
        return Independent()
    batches = [1 << bits for bits in range(_MOST.bit_length())]
    known: list[Sampler] = []
    for batch in batches:
        if sampler is None:
            known += [kind(batch) for kind in (Stratified, Halton, Sobol, Lattice)]
        else:
            known.append(changed(sampler, batch=batch))
    return next((one for one in known if repr(one) == begun), None)


def _batch(limits: Limits, adaptive: bool, apart: bool) -> tuple[int, str]:
    """Return the samples of a batch, and why it has as many."""
    samples, error, seconds = limits
    # The samples of an adaptive picture are in halves, each with batches of its own.
    halves = 1 + adaptive
    options = []
    if samples is not None:
        batch = _core.batch_for(samples)
        told = "a batch" if samples < 2 * batch else f"{samples * halves // batch} batches"
        options.append((batch, f"the error of {samples} samples is told by {told}"))
    if error is not None:
        likely = int(min(expected((None, error, None), 1), 2.0**31))
        options.append((_core.batch_for(likely), f"an error of {error:g} may end it after {likely} samples"))
    if seconds is not None:
        options.append((_TIMED_APART if apart else _TIMED, "time may end it after few samples"))
    batch, why = min(options, key=lambda option: option[0])
    return max(batch // halves, 1), why
