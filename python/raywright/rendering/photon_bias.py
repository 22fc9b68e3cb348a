"""Pictures of photon maps: the decay of their error, and their bias by blur."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from .. import _core
from ..integrators import AnyIntegrator, Bidirectional, PhotonMap, ProgressivePhotonMap
from .auto_options import StoppedError
from .image import Image
from .job import Job


def is_gathered(integrator: AnyIntegrator) -> bool:
    """Return whether light is gathered from about a point."""
    merges = isinstance(integrator, Bidirectional) and integrator.vertex_merging
    return merges or isinstance(integrator, PhotonMap | ProgressivePhotonMap)


def rate(integrator: AnyIntegrator) -> float:
    """Return the power of the samples that noise falls by, squared: less than 1 where radii shrink.

    Each sample is the noisier the smaller its radius is (Knaus and Zwicker 2011).
    """
    if isinstance(integrator, ProgressivePhotonMap):
        return integrator.alpha
    return 2 / 3 if is_gathered(integrator) and not isinstance(integrator, PhotonMap) else 1.0


def with_bias(
    image: Image,
    error: float | None,
    done: _core.Rendering,
    job: Job,
    threads: int | None,
    look: Callable[[], None] | None,
) -> Image:
    """Return an image with its bias; NaN if the render stopped before there was an estimate.

    A bias above the requested error gives a warning: more samples with the same radius do not help.
    """
    try:
        told = done.bias(job.core, job.scene._compiled(), threads, look)
    except StoppedError:
        told = None
    bias, bias_error = told if told is not None else [np.full(done.rgb.shape, np.nan, np.float32)] * 2
    image = replace(image, biased=True, bias=bias, bias_error=bias_error)
    blur = _relative(image.rgb, bias, bias_error)
    if error is None or not blur > error:
        return image
    line = (
        f"error={error:g} is of noise alone, and light gathered from about a point may be off by a relMSE of "
        f"{blur:.2g} (`bias`): a smaller radius has less"
    )
    return replace(image, warnings=(*image.warnings, line))


def _relative(picture: NDArray[np.float32], off: NDArray[np.float32], noise: NDArray[np.float32]) -> float:
    """Return the relMSE of a picture with this bias, as far as it is more than noise."""
    off = off.astype(np.float64)
    truth = picture.astype(np.float64) - off
    return max(0.0, float(np.mean((off**2 - noise.astype(np.float64) ** 2) / (truth**2 + 0.01))))
