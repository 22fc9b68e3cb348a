"""Pictures of the core's renders."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import _core
from ..scene.scene import Scene
from .error_estimate import ErrorEstimate
from .image import HISTORY, Image
from .plan import RenderPlan


def made(
    done: _core.Rendering,
    clamp: float | None,
    aov: dict[str, NDArray[Any]],
    told: Iterable[str],
    plan: RenderPlan,
    alpha: NDArray[np.float32] | None = None,
) -> Image:
    """Return the picture of a render at rest.

    Parameters
    ----------
    done : _core.Rendering
        The render.
    clamp : float, optional
        As in `render`.
    aov : dict
        Auxiliary buffers.
    told : iterable of str
        Further warnings.
    plan : RenderPlan
        The plan.
    alpha : (H, W) array, optional
        Coverage of pixels.
    """
    warnings = list(told)
    rgb = done.rgb
    standard_error, pooled, degrees = done.uncertainty or (np.full_like(rgb, np.nan), None, None)
    if done.dropped:
        counts = "counts" if done.dropped == 1 else "count"
        warnings.append(f"{_samples(done.dropped)} not finite or negative, and {counts} as black")
    clamped, taken = done.clamped
    if clamped:
        warnings.append(
            f"biased: {_samples(clamped)} clamped to {clamp:g}, which took {_share(taken)} of the radiance"
        )
    return Image(
        rgb,
        standard_error,
        **overall(done),
        warnings=(*warnings, *doubts(done)),
        biased=clamped > 0,
        aov=aov,
        plan=plan,
        pooled_error=pooled,
        degrees=degrees,
        alpha=alpha,
    )


def shines(scene: Scene) -> bool:
    """Return whether a scene has any light, except for emission of media."""
    if scene.lights or scene.environment is not None:
        return True
    left: list[Any] = list(scene.shapes)
    while left:
        shape = left.pop()
        if getattr(shape, "emission", None) is not None:
            return True
        left += getattr(shape, "shapes", ())
    return False


def doubted(image: Image, scene: Scene) -> Image:
    """Return an image, with the reason if it is black for want of light."""
    if image.rgb.any() or shines(scene):
        return image
    why = "black, as the scene has no light: give environment=1.0, lights=, or a shape with emission="
    return replace(image, warnings=(*image.warnings, why))


def overall(done: _core.Rendering) -> dict[str, Any]:
    """Return the statistics of all pixels."""
    rows = done.history
    history = np.empty(len(rows), HISTORY)
    for i, name in enumerate(HISTORY.names or ()):
        history[name] = rows[:, i]
    error = ErrorEstimate(*done.error, trusted=done.trusted)
    return {"error": error, "history": history, "seconds": done.seconds, "samples": done.samples}


def doubts(done: _core.Rendering) -> list[str]:
    """Return the warnings about the error estimate."""
    if done.carried is not None:
        few, share = done.carried
        carriers = "one sample carries" if few == 1 else f"{few} samples carry"
        return [f"{carriers} {100 * share:.0f} % of the error estimate: it cannot be trusted yet"]
    if done.trusted:
        return []
    _, low, high = done.error
    return [
        f"light is found so rarely that the error may be {low:.2g} or {high:.2g}: "
        "its estimate cannot be trusted yet"
    ]


def _share(of_all: float) -> str:
    """Return a share in percent, by two digits or as 100."""
    return f"{100 * of_all:.2g} %" if of_all < 0.995 else "100 %"


def _samples(count: int) -> str:
    return f"{count} sample{' was' if count == 1 else 's were'}"
