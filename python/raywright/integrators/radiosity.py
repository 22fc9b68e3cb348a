"""Pictures of a radiosity solution."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ..exchange.solution import RadiositySolution
from .base import CoreIntegrator


@dataclass(frozen=True)
class Radiosity(CoreIntegrator):
    """Display of a radiosity solution from any camera: one ray per sample, without further scattering.

    A hit shows its emission and the reflected irradiance of its patch. Textures are those of the scene, not
    the means of patches; rays that miss see the environment.

    Parameters
    ----------
    solution : RadiositySolution
        Result of `radiosity` for the rendered scene; with ``per="vertex"`` it is interpolated.

    Raises
    ------
    TypeError
        If it is not a solution.
    ValueError
        When rendering, if the number of faces or their area shows that it belongs to another scene.

    See Also
    --------
    radiosity : Finds the solution.

    Examples
    --------
    >>> scene, camera = rw.scenes.cornell_box(width=4, height=4)
    >>> solution = rw.radiosity(scene, rays=1000, progress=False)
    >>> image = rw.render(scene, camera, rw.Radiosity(solution), samples=1, progress=False)
    >>> bool(image.rgb.mean() > 0)
    True
    """

    solution: RadiositySolution

    def __post_init__(self) -> None:
        if not isinstance(self.solution, RadiositySolution):
            raise TypeError(
                f"solution must be a result of raywright.radiosity, got {type(self.solution).__name__}"
            )

    @cached_property
    def _table(self) -> tuple[Any, ...]:
        """The core's lookup table."""
        solution = self.solution
        patches = solution.patches
        is_front = patches["side"] == 1
        # One patch per face, in their order, and the first patch of each primitive.
        faces = patches[is_front & (patches["cell"] == 0)]
        starts = np.flatnonzero((faces["copy"] < 0) | (faces["face"] == 0))
        first = np.append(starts, len(faces)).astype(np.uint32)
        has_backs = not bool(is_front.all())
        return (
            solution.cuts,
            first,
            solution.mirrored,
            solution.corner_irradiance,
            has_backs,
            solution.surface_area,
        )

    def __getstate__(self) -> dict[str, Any]:
        return {"solution": self.solution}

    def __setstate__(self, state: dict[str, Any]) -> None:
        vars(self).update(state)
