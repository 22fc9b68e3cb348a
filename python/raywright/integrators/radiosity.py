"""Pictures of a radiosity solution."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

from ..exchange.solution import RadiositySolution


@dataclass(frozen=True)
class Radiosity:
    """Looks a radiosity solution up from any camera: one ray a sample, and nothing is scattered anew.

    What a ray meets shows what it emits and what it reflects of the irradiance of its patch. Textures are
    those of the scene, not the means of patches; what meets nothing is the environment.

    Parameters
    ----------
    solution : RadiositySolution
        What `radiosity` has found of the scene that is rendered; smooth with ``per="vertex"``.

    Raises
    ------
    TypeError
        If it is no solution.
    ValueError
        When rendering, if it is of another scene, by its number of faces or their area.
    """

    solution: RadiositySolution

    def __post_init__(self) -> None:
        if not isinstance(self.solution, RadiositySolution):
            raise TypeError(f"solution must be of raywright.radiosity, got {type(self.solution).__name__}")

    @cached_property
    def _table(self) -> tuple[Any, ...]:
        """What the core looks up."""
        solution = self.solution
        is_front = solution.patches["side"] == 1
        area = float(solution.areas[is_front].sum())
        return solution.cuts, solution.corner_irradiance, not bool(is_front.all()), area

    def __getstate__(self) -> dict[str, Any]:
        return {"solution": self.solution}

    def __setstate__(self, state: dict[str, Any]) -> None:
        vars(self).update(state)
