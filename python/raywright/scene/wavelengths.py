"""The reason for spectral rendering, if there is one."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

from ..materials.dispersion import Dispersion
from ..shapes.shape import Shape
from ..textures.spectrum import Spectrum
from .instance import Instance


def reason(shapes: Iterable[Any], others: Iterable[Any]) -> str | None:
    """Return the dispersive parts of shapes, lights and media: None where red, green and blue do."""
    seen: set[int] = set()
    told = (_of_shape(shape, seen) for shape in shapes)
    first = next((why for why in told if why), None)
    return first or next((why for other in others if (why := _of(other, "", seen))), None)


def _of_shape(shape: Any, seen: set[int]) -> str | None:
    if isinstance(shape, Instance):
        if id(shape.shapes) in seen:
            return None
        seen.add(id(shape.shapes))
        return next((why for one in shape.shapes if (why := _of_shape(one, seen))), None)
    return _of(shape.material, "", seen) or _of(shape.emission, "emission", seen)


def _of(thing: Any, name: str, seen: set[int]) -> str | None:
    """Return the reason for which a description needs spectral rendering."""
    if isinstance(thing, Dispersion):
        return f"the {name} of glass goes with wavelength, by {type(thing).__name__}'s formula"
    if isinstance(thing, Spectrum):
        return f"a {name or 'color'} is a {type(thing).__name__}"
    if isinstance(thing, tuple):
        return next((why for one in thing if (why := _of(one, name, seen))), None)
    if isinstance(thing, Shape | np.ndarray) or not is_dataclass(thing) or id(thing) in seen:
        return None
    seen.add(id(thing))
    inner = ((field.name, getattr(thing, field.name)) for field in fields(thing))
    return next((why for name, one in inner if (why := _of(one, name, seen))), None)
