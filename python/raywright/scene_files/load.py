"""Files of all kinds, ready to be rendered."""

from __future__ import annotations

import errno
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import Any, Literal

import numpy as np

from ..arrays import choice
from ..mesh_files import meshes
from ..rendering.render_setup import RenderSetup
from ..rendering.samplers import Sampler
from ..scene.framing import outline
from ..shapes.welding import Weld, weld_tolerance
from .mitsuba import from_mitsuba
from .shown import shown

USD = (".usd", ".usda", ".usdc", ".usdz")
# Suffixes of files that may have their own cameras and lights.
SCENES = (".xml", ".pbrt", ".pbrt.gz", ".glb", ".gltf", *USD)


def has_camera(path: str | PathLike[str]) -> bool:
    """Return whether a file is of a kind that has scenes rather than meshes only, by its suffix."""
    return Path(path).name.lower().endswith(SCENES)


# Numeric problems of file contents are reported otherwise.
@np.errstate(all="ignore")
def load(
    path: str | PathLike[str],
    up: Literal["y", "z"] = "y",
    width: int | None = None,
    height: int | None = None,
    sampler: Sampler | None = None,
    weld: Weld = "auto",
    **parameters: Any,
) -> RenderSetup:
    """Read a scene, or a mesh, with the camera, lights and options of a picture.

    A file with light is rendered in its own light: lights, or emissive surfaces with at least 0.02 W·sr⁻¹·m⁻²
    on average over all surfaces, or any emission if the file has a camera. Other files are lit as in
    `scenes.studio`: for the file's camera, or else framed and on a floor.

    Parameters
    ----------
    path : str or path
        ``.xml``, a scene of Mitsuba 3, as `from_mitsuba` reads it; ``.pbrt`` or ``.pbrt.gz``, one of
        pbrt-v4; ``.glb`` or
        ``.gltf``; ``.usd``, ``.usda``, ``.usdc`` or ``.usdz``, for which there is
        ``pip install 'raywright[usd]'``; or a mesh file: OBJ with its materials, PLY, STL, OFF, or any other
        that trimesh reads.
    up : {"y", "z"}
        The axis that points up in formats without a convention; in glTF it is y.
    width, height : int, optional
        Size of the picture in pixels: the file's own if not given, or 640 by 480 for a file without a camera.
        If only one is given, the other keeps the proportions.
    sampler : Independent, Stratified, Halton, Sobol or Lattice, optional
        Sampler in place of the file's. If not given, the file's own; Mitsuba's default, ``independent``,
        counts as none.
    weld : "auto", float or None
        Welding distance of corners of meshes, in the scene's unit. "auto" is the rounding of the file's own
        precision, as for `Scene`; None for equal corners only. Only positions change: corners with different
        normals, coordinates or colors stay separate vertices.
    **parameters
        Values of ``$name`` in a scene of Mitsuba, in place of its defaults: ``spp=16``. For parameters with
        the names of other arguments, use ``from_mitsuba(parameters=)``.

    Returns
    -------
    RenderSetup
        ``shot.render()`` makes a picture of it.

    Raises
    ------
    FileNotFoundError
        If the file, or one that it names, is missing.
    ValueError
        If the file cannot be read, or holds something that is not supported; if a number is out of range, or
        `weld` is negative or not finite.
    TypeError
        If `path` is not a path, a size is not an integer, `sampler` is not a sampler, or
        `parameters` is given for a file that is not Mitsuba's.
    ImportError
        If the package that reads the kind of file is not installed, such as usd-core for USD; it is named.

    Warns
    -----
    RuntimeWarning
        Once for each kind of feature in the file that is ignored or approximated.

    See Also
    --------
    from_mitsuba : Scenes of Mitsuba, from dicts too.
    Mesh.of : Meshes alone.

    Examples
    --------
    >>> rw.scenes.torus_knot(along=40, around=8).save("knot.ply")
    >>> shot = rw.load("knot.ply", width=16)
    >>> shot.camera.width, shot.camera.height
    (16, 12)
    >>> shot.render(samples=1, progress=False).rgb.shape
    (12, 16, 3)
    """
    if not isinstance(path, str | PathLike):
        raise TypeError(f"path must be a str or a path, got {type(path).__name__}")
    choice("up", up, ("y", "z"))
    if sampler is not None and not isinstance(sampler, Sampler):
        raise TypeError(f"sampler must be one of raywright's, got {type(sampler).__name__}")
    weld_tolerance(weld)
    shot = _read(Path(path), up, width, height, weld, parameters)
    return shot if sampler is None else replace(shot, sampler=sampler)


def _read(
    path: Path,
    up: Literal["y", "z"],
    width: int | None,
    height: int | None,
    weld: Weld,
    parameters: dict[str, Any],
) -> RenderSetup:
    if not path.exists():
        raise FileNotFoundError(errno.ENOENT, "no such file", str(path))
    suffix = path.suffix.lower()
    if suffix == ".xml":
        return from_mitsuba(path, parameters=parameters, weld=weld).resized(width, height)
    if parameters:
        raise TypeError(
            f"{next(iter(parameters))} is not a parameter of {path}: only Mitsuba scenes have parameters"
        )
    if path.name.lower().endswith((".pbrt", ".pbrt.gz")):
        from .pbrt import read_pbrt

        return _welded(read_pbrt(path).resized(width, height), weld)
    if suffix in USD:
        from .usd import read_usd

        return _welded(read_usd(path, width, height), weld)
    if suffix in SCENES:
        from .gltf import read_gltf

        return _welded(read_gltf(path, width, height), weld)
    found = meshes.load(path, weld)
    try:
        outline(found)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from error
    shot = shown(found, up=up, width=width, height=height)
    return replace(shot, scene=shot.scene.replace(weld=weld))


def _welded(shot: RenderSetup, weld: Weld) -> RenderSetup:
    """Return the shot with corners of meshes put in one place that differ by rounding."""
    return replace(shot, scene=shot.scene.replace(weld=weld).welded())
