"""The base class of materials."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypeAlias

from ..arrays import choice, number
from ..textures.texture import Number, Texture, Value, scalar, value

Rough: TypeAlias = Number | tuple[Number, Number]

DISTRIBUTIONS = ("ggx", "beckmann")


@dataclass(frozen=True, init=False)
class Material:
    """The base class of materials: how a surface scatters light. Its subclasses say how it scatters light."""

    def _set(self, **values: Any) -> None:
        for name, kept in values.items():
            object.__setattr__(self, name, kept)


def material(name: str, given: Material) -> Material:
    """Return a checked material.

    Raises
    ------
    TypeError
        If it is none.
    """
    if not isinstance(given, Material):
        raise TypeError(f"{name} must be a raywright material, got {type(given).__name__}")
    return given


def rough(roughness: Any, alpha: Any, default: float = 0.0, pair: bool = True) -> dict[str, Rough | None]:
    """Return a roughness or an alpha, checked: one number or texture in [0, 1], or where allowed a pair.

    Raises
    ------
    ValueError
        If both are given, or a number is out of range.
    TypeError
        If something is neither a number nor a texture.
    """
    if roughness is not None and alpha is not None:
        raise ValueError("only one of roughness and alpha can be given: alpha is the square of roughness")
    if roughness is None and alpha is None:
        roughness = default
    return {
        "roughness": None if roughness is None else _one_or_two("roughness", roughness, pair),
        "alpha": None if alpha is None else _one_or_two("alpha", alpha, pair),
    }


def _one_or_two(name: str, given: Any, pair: bool) -> Rough:
    if isinstance(given, Texture) or not hasattr(given, "__len__"):
        return scalar(name, given, most=1.0)
    if not pair or isinstance(given, str) or len(given) != 2:
        expected = "one number or texture, or a pair of them" if pair else "one number or texture"
        raise ValueError(f"{name} must be {expected}, got {given!r}")
    return scalar(f"{name}[0]", given[0], most=1.0), scalar(f"{name}[1]", given[1], most=1.0)


def facets(distribution: str, multiple_scattering: bool) -> dict[str, Any]:
    """Return which facets a rough surface has and whether all of their light is followed, checked.

    Raises
    ------
    ValueError
        If there is no such distribution.
    TypeError
        If `multiple_scattering` is not a bool.
    """
    choice("distribution", distribution, DISTRIBUTIONS)
    if not isinstance(multiple_scattering, bool):
        raise TypeError(f"multiple_scattering must be True or False, got {multiple_scattering!r}")
    return {"distribution": distribution, "multiple_scattering": multiple_scattering}


def number_from(name: str, given: float, least: float) -> float:
    """Return one finite number that is not below `least`.

    Raises
    ------
    ValueError
        If it is.
    TypeError
        If `given` is not a number.
    """
    result = number(name, given)
    if result < least:
        raise ValueError(f"{name} must be at least {least:g}, got {given}")
    return result


def highlights(diffuse: Any, specular: Any, exponent: Any, ambient: Any) -> dict[str, Value | Number]:
    """Return the parameters of a surface that is partly matt and partly shiny, checked.

    Raises
    ------
    ValueError
        If a number is out of range, or the two shares add up to more than 1.
    TypeError
        If one is neither a number nor a texture.
    """
    matt, shiny = value("diffuse", diffuse, most=1.0), value("specular", specular, most=1.0)
    if not isinstance(matt, Texture) and not isinstance(shiny, Texture):
        most = max(d + s for d, s in zip(matt, shiny, strict=True))
        # Sums of shares such as 0.9 and 0.1 may be rounded up.
        if most > 1 + 1e-12:
            raise ValueError(f"diffuse and specular must add up to at most 1, got {most:g}")
    return {
        "diffuse": matt,
        "specular": shiny,
        "exponent": scalar("exponent", exponent),
        "ambient": matt if ambient is None else value("ambient", ambient),
    }
