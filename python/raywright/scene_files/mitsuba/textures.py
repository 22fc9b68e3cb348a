"""Textures: pictures and checkerboards, and values that may be textures or constants."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..._core import smooth_spectrum
from ...io.pictures import read
from ...textures import Checker, ImageTexture, ProductTexture, Spectrum, UvTransform, VertexColors
from ...textures.texture import Number, Texture, Value
from .plugin import Plugin, Triple
from .solid import VOLUME, held
from .uv import UPRIGHT, Uv
from .values import UNIFORM, at_each_nm, color, of_plugin, shade

# Luminance of linear Rec. 709.
_LUMINANCE = np.array([0.212671, 0.715160, 0.072169])

TYPES = ("bitmap", "checkerboard", "mesh_attribute", VOLUME)

# A change of colors, applied to constants and to each pixel of a picture.
Change = Callable[[NDArray[np.float64]], NDArray[np.float64]]


def value(
    plugin: Plugin,
    name: str,
    default: float | Triple,
    uv: Uv,
    emits: bool = False,
    change: Change | None = None,
) -> Value:
    """Return a parameter that is a color or a texture of colors.

    Parameters
    ----------
    plugin : Plugin
        Plugin with the parameter.
    name : str
        Name of the parameter.
    default : float or 3 floats
        If it is not given.
    uv : Uv
        Where the surface has its texture coordinates.
    emits : bool
        True for light rather than a share of light.
    change : function, optional
        Function applied to its colors.
    """
    inner = plugin.child(name)
    whole = _whole(inner)
    if inner is None or inner.type in UNIFORM or whole is not None:
        found = shade(plugin, name, default, emits) if whole is None else shade(whole, "value", 1.0, emits)
        if change is None:
            return found
        if plugin.context.by_wavelength and not isinstance(found, Spectrum) and len({*found}) > 1:
            # Among spectra, a color becomes a smooth spectrum; the change applies to that.
            nm = np.arange(360.0, 831.0, 5.0)
            found = Spectrum(nm, smooth_spectrum(found, True, False, nm.tolist()))
        return at_each_nm(found, change) if isinstance(found, Spectrum) else _changed(found, change)
    return texture(inner, uv, change)


def scalar(plugin: Plugin, name: str, default: float, uv: Uv) -> Number:
    """Return a parameter that is a number or a texture.

    Of a picture's colors the luminance counts, and of other colors the mean of red, green and blue.
    """
    inner = plugin.child(name)
    if inner is None:
        return plugin.number(name, default)
    if inner.type in UNIFORM:
        return float(np.mean(of_plugin(inner, False)))
    whole = _whole(inner)
    return numbers(inner, uv) if whole is None else float(np.mean(color(whole, "value", 1.0)))


def _whole(plugin: Plugin | None) -> Plugin | None:
    """Return the volume of a texture that is the same everywhere; None if it is none."""
    if plugin is None or plugin.type != VOLUME:
        return None
    found = held(plugin)
    if found.type != "constvolume":
        return None
    found.ignore("to_world")
    plugin.done()
    return found


def numbers(plugin: Plugin, uv: Uv) -> Texture:
    """Return a texture of numbers."""
    if plugin.type == "checkerboard":
        # For scalar parameters, Mitsuba (3.9) swaps the two colors.
        return _checkerboard(plugin, uv, None, ("color1", "color0"))
    return texture(plugin, uv, _gray, gray=True)


def _gray(colors: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.repeat((colors @ _LUMINANCE)[..., None], 3, axis=-1)


def texture(plugin: Plugin, uv: Uv, change: Change | None = None, gray: bool = False) -> Texture:
    """Return a texture of colors, or if it is to be `gray`, of numbers that `change` makes of colors."""
    if plugin.type == "bitmap":
        return _bitmap(plugin, uv, change, gray)
    if plugin.type == "checkerboard":
        return _checkerboard(plugin, uv, change, ("color0", "color1"))
    if plugin.type == "mesh_attribute":
        return _attribute(plugin, None if gray else change)
    if plugin.type == VOLUME:
        return _solid(plugin, None if gray else change)
    plugin.fail("this kind of texture is not supported")


def _attribute(plugin: Plugin, change: Change | None) -> Texture:
    """Return what the vertices of a mesh have, which is given to it with its shape."""
    if change is not None:
        plugin.fail("it cannot color the base of a plastic")
    plugin.text("name")
    scale = plugin.number("scale", 1.0)
    plugin.done()
    return VertexColors() if scale == 1.0 else ProductTexture(VertexColors(), scale)


def _solid(plugin: Plugin, change: Change | None) -> Texture:
    """Return what a grid has at the vertices of a mesh, which is given to it with its shape."""
    if change is not None:
        plugin.fail("it cannot color the base of a plastic")
    held(plugin)
    plugin.done()
    return VertexColors()


def picture(plugin: Plugin) -> tuple[NDArray[Any], bool]:
    """Return the picture that a plugin names or holds, (H, W, 1 or 3), and whether it is linear.

    Of 8 bits it stays so; alpha is left out.
    """
    given = [name for name in ("filename", "bitmap", "data") if plugin.has(name)]
    if len(given) != 1:
        plugin.fail("one of filename, bitmap and data must be given")
    raw = plugin.switch("raw", False)
    linear = raw or given == ["data"]
    if given == ["filename"]:
        path = plugin.path()
        kept = plugin.context.kept
        if path not in kept:
            kept[path] = read(path)
        array = kept[path]
    else:
        held = plugin.take(given[0])
        array = np.asarray(held)
        gamma = getattr(held, "srgb_gamma", None)
        linear = linear or (callable(gamma) and not gamma())
    if array.ndim == 2:
        array = array[..., None]
    if array.ndim != 3 or not 1 <= array.shape[2] <= 4 or 0 in array.shape:
        plugin.fail(f"a picture must have shape (H, W, 1 to 4), got {array.shape}")
    array = array[..., : 3 if array.shape[2] > 2 else 1]
    return array, linear or array.dtype.kind == "f"


def heights(plugin: Plugin) -> NDArray[np.float64]:
    """Return the luminance of the picture that a plugin names or holds, (H, W)."""
    array, linear = picture(plugin)
    colors = linear_colors(array, linear)
    return colors[..., 0] if array.shape[2] == 1 else colors @ _LUMINANCE


def normals(plugin: Plugin, uv: Uv) -> ImageTexture:
    """Return a picture of normals, along u and v as in raywright."""

    def turn(colors: NDArray[np.float64]) -> NDArray[np.float64]:
        # Mitsuba's bitangent makes a right-handed frame with u and the normal.
        return np.stack([colors[..., 0], 1 - colors[..., 1], colors[..., 2]], -1)

    if plugin.type == "rawconstant":
        tilted = np.array([[plugin.vector("value", (0.5, 0.5, 1.0))]], np.float64)
        plugin.done()
        tilted = turn(tilted) if uv.left_handed else tilted
        return ImageTexture(tilted.astype(np.float32), linear=True)
    if plugin.type != "bitmap":
        plugin.fail("a normal map must be a bitmap or a rawconstant")
    if uv.turned:
        plugin.fail("a normal map on a disk is not supported")

    return _bitmap(plugin, uv, turn if uv.left_handed else None, False)


def _bitmap(plugin: Plugin, uv: Uv, change: Change | None, gray: bool) -> ImageTexture:
    array, linear = picture(plugin)
    nearest = plugin.choice("filter_type", "bilinear", ("bilinear", "nearest")) == "nearest"
    wrap = plugin.choice("wrap_mode", "repeat", ("repeat", "mirror", "clamp"))
    matrix = UPRIGHT @ plugin.to_uv() @ uv.matrix
    plugin.ignore("format", "accel")
    plugin.done()
    if change is not None and not (gray and array.shape[2] == 1):
        array, linear = change(linear_colors(array, linear)).astype(np.float32), True
        array = array[..., :1] if gray else array
    return ImageTexture(
        array,
        linear=linear,
        filter="nearest" if nearest else "bilinear",
        wrap=wrap,  # type: ignore[arg-type]
        transform=UvTransform(matrix=matrix[:2]),
    )


def linear_colors(array: NDArray[Any], linear: bool) -> NDArray[np.float64]:
    """Return a picture as linear colors, (H, W, 3)."""
    shares = array / np.iinfo(array.dtype).max if array.dtype.kind == "u" else array.astype(np.float64)
    if not linear:
        shares = np.where(shares <= 0.04045, shares / 12.92, ((shares + 0.055) / 1.055) ** 2.4)
    return np.broadcast_to(shares, (*array.shape[:2], 3))


def _checkerboard(plugin: Plugin, uv: Uv, change: Change | None, names: tuple[str, str]) -> Texture:
    default = {"color0": 0.4, "color1": 0.2}
    a, b = (value(plugin, name, default[name], uv, change=change) for name in names)
    matrix = plugin.to_uv() @ uv.matrix
    plugin.done()
    if isinstance(a, Texture) or isinstance(b, Texture):
        # Two cells per unit.
        return Checker(a, b, UvTransform(matrix=(np.diag([2.0, 2.0, 1.0]) @ matrix)[:2]))
    # Its cells keep sharp edges at any distance, unlike those of `Checker`.
    cells = np.array([(b, a), (a, b)], np.float32)
    return ImageTexture(cells, filter="nearest", transform=UvTransform(matrix=matrix[:2]))


def _changed(found: Triple, change: Change) -> Triple:
    red, green, blue = (float(x) for x in change(np.array(found)))
    return red, green, blue
