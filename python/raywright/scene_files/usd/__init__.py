"""Scenes of USD: meshes with their preview surfaces, cameras and lights, by PyPI's usd-core."""

import errno
from pathlib import Path
from typing import Any, Literal

import numpy as np

from ...arrays import integer
from ...io.quiet import refused
from ...rendering.shot import Shot
from ...scene.scene import Scene
from ..shown import shown
from .cameras import camera
from .lights import light
from .notes import Notes, told_of
from .shapes import shapes

__all__ = ["read_usd"]

NO_USD = "reading USD needs usd-core: pip install 'raywright[usd]'"


def read_usd(path: Path, width: int | None = None, height: int | None = None) -> Shot:
    """Read a USD file: all that its stage shows at its first time.

    Parameters
    ----------
    path : Path
        The file.
    width, height : int, optional
        Size of the picture in pixels, as `load` has them.

    Returns
    -------
    Shot
        The stage's shapes, in the light of its own or, where it has none, of `scenes.studio`; seen by the
        first of its cameras, or framed.

    Raises
    ------
    ImportError
        If usd-core is not installed.
    FileNotFoundError
        If a file that it names is missing.
    ValueError
        If it is no USD file that can be read, or holds nothing that is seen; tells which prim is wrong.

    Warns
    -----
    RuntimeWarning
        Once of each kind of thing in the file that is not shown as it says.

    Notes
    -----
    Meshes are shown as their faces are, without being subdivided. Lights give off ``intensity`` times 2 to
    the ``exposure`` as a radiance, or over their area where they are normalised.
    """
    try:
        from pxr import Tf, Usd, UsdGeom
    except ImportError as error:
        raise ImportError(NO_USD) from error

    for name, size in (("width", width), ("height", height)):
        if size is not None:
            integer(name, size, 1, 65536)
    try:
        stage = Usd.Stage.Open(str(path))
    except Tf.ErrorException as error:
        raise refused(path, "USD file", ValueError("its stage cannot be opened")) from error
    notes = Notes(path)
    _composed(stage, path, notes)
    up: Literal["y", "z"] = "z" if UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.z else "y"
    try:
        found: list[Any] = []
        lights: list[Any] = []
        around: list[Any] = []
        cameras: list[Any] = []
        time = (
            Usd.TimeCode(stage.GetStartTimeCode())
            if stage.HasAuthoredTimeCodeRange()
            else Usd.TimeCode.Default()
        )
        placed = UsdGeom.XformCache(time)
        for prim in _seen(stage, time):
            with told_of(prim):
                matrix = np.array(placed.GetLocalToWorldTransform(prim), np.float64).T
                if prim.IsA(UsdGeom.Camera):
                    cameras.append((prim, matrix))
                elif (made := light(prim, matrix, time, notes)) is not None:
                    {"light": lights, "shape": found, "around": around}[made.kind].append(made.thing)
                else:
                    found += shapes(prim, matrix, time, notes)
        if not found:
            raise ValueError("it holds nothing that is seen")
        if len(cameras) > 1:
            notes.tell(f"the first of its {len(cameras)} cameras is taken")
        eye = camera(cameras[0][0], cameras[0][1], time) if cameras else None
        shot = shown(found, lights, eye, up=up, width=width, height=height)
        if lights or around or any(getattr(one, "emission", None) is not None for one in found):
            # It has light of its own, which surfaces that are no meshes give too.
            shot = Shot(Scene(found, lights, around[0] if len(around) == 1 else around or None), shot.camera)
    except (ImportError, MemoryError, FileNotFoundError):
        raise
    except Exception as error:
        raise refused(path, "USD file", error) from error
    notes.warn()
    return shot


def _composed(stage: Any, path: Path, notes: Notes) -> None:
    """Refuse a stage of which a file is missing, and note what else of it could not be put together."""
    for error in stage.GetCompositionErrors():
        line = " ".join(str(error).split())
        if "AssetPath" in type(error).__name__ or "SublayerPath" in type(error).__name__:
            name = line.partition("@")[2].partition("@")[0]
            if name and not (path.parent / name).exists():
                raise FileNotFoundError(errno.ENOENT, "no such file", str(path.parent / name))
        notes.tell(f"it is not put together as it says: {line.partition(':')[0][:200]}")


def _seen(stage: Any, time: Any) -> Any:
    """Yield the prims that are seen, those of instances too."""
    from pxr import Usd, UsdGeom

    walk = iter(Usd.PrimRange(stage.GetPseudoRoot(), Usd.TraverseInstanceProxies()))
    for prim in walk:
        if prim.IsPseudoRoot():
            continue
        seen = UsdGeom.Imageable(prim)
        if seen and (
            seen.GetVisibilityAttr().Get(time) == "invisible"
            or seen.GetPurposeAttr().Get() in ("guide", "proxy")
        ):
            walk.PruneChildren()
            continue
        yield prim
        if prim.IsA(UsdGeom.PointInstancer):
            # What it copies is read with it.
            walk.PruneChildren()
