"""The base class of textures, and values that may be textures or constants."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar, TypeAlias, Union

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Triple, real_array

Value: TypeAlias = Union[Triple, "Texture"]
Number: TypeAlias = Union[float, "Texture"]


@dataclass(frozen=True, init=False)
class Texture:
    """The base class of textures: values that vary over a surface. Its subclasses say how."""

    # True if it may stand for a number, such as a roughness.
    _is_number: ClassVar[bool] = True

    @property
    def range(self) -> tuple[Triple, Triple]:
        """Bounds of its values: the least and the greatest red, green and blue."""
        raise NotImplementedError

    def _set(self, **values: Any) -> None:
        for name, value in values.items():
            object.__setattr__(self, name, value)


def value(
    name: str, given: ArrayLike | Texture, least: float = 0.0, most: float = math.inf, above: bool = False
) -> Value:
    """Return a texture as it is, or one number or three as three floats: each finite and in least..most.

    Parameters
    ----------
    name : str
        The argument's, for errors.
    given : float, 3 floats or Texture
        The value.
    least, most : float
        Allowed range.
    above : bool
        True if `least` itself is not allowed.

    Raises
    ------
    ValueError
        If a number, or the range of a texture, is not finite or not allowed, or there are neither 1 nor 3 of
        them.
    TypeError
        If `given` is not a number.
    """
    if isinstance(given, Texture):
        low, high = given.range
        _check(name, (*low, *high), f"a texture of {min(low):.6g} to {max(high):.6g}", least, most, above)
        return given
    array = real_array(name, given)
    if array.shape not in ((), (3,)):
        raise ValueError(f"{name} must be one number or 3, got shape {array.shape}")
    red, green, blue = (float(x) for x in np.broadcast_to(array, 3))
    _check(name, (red, green, blue), repr(given), least, most, above)
    return red, green, blue


def scalar(
    name: str, given: float | Texture, least: float = 0.0, most: float = math.inf, above: bool = False
) -> Number:
    """Return a texture as it is, or one number as a float; errors as those of `value`.

    Of a texture with colors, the mean of the channels counts.
    """
    if isinstance(given, Texture):
        if not given._is_number:
            raise TypeError(f"{name} must be a texture or one number, got a {type(given).__name__}")
        value(name, given, least, most, above)
        return given
    array = real_array(name, given)
    if array.ndim:
        raise ValueError(f"{name} must be a texture or one number, got shape {array.shape}")
    result = float(array)
    _check(name, (result,), repr(given), least, most, above)
    return result


def ends(given: Value) -> tuple[Triple, Triple]:
    """Return the least and the greatest that a value may be."""
    return given.range if isinstance(given, Texture) else (given, given)


def either(a: Value, b: Value) -> tuple[Triple, Triple]:
    """Return the range of a value that is one of two values, or between them."""
    (low, high), (least, most) = ends(a), ends(b)
    x, y, z = map(min, low, least)
    r, s, t = map(max, high, most)
    return (x, y, z), (r, s, t)


def _check(name: str, numbers: tuple[float, ...], came: str, least: float, most: float, above: bool) -> None:
    if not all(map(math.isfinite, numbers)):
        raise ValueError(f"{name} must be finite, got {came}")
    if min(numbers) < least or max(numbers) > most or (above and min(numbers) <= least):
        if above:
            allowed = f"greater than {least:g}"
        elif most == math.inf:
            allowed = f"at least {least:g}"
        else:
            allowed = f"between {least:g} and {most:g}"
        raise ValueError(f"{name} must be {allowed}, got {came}")
