"""Scenes of USD: meshes with their preview surfaces, cameras and lights, by PyPI's usd-core."""

from __future__ import annotations

import errno
from collections import Counter
from pathlib import Path
from typing import Any, Literal

from ...arrays import integer
from ...cameras import AnyCamera
from ...io.quiet import refused
from ...public_names import public_names
from ...rendering.render_setup import RenderSetup
from ...scene.scene import Scene
from ..shown import shown
from .cameras import camera, exposure
from .instancers import placed
from .lights import is_light, light
from .meshes import UNPOSED
from .notes import Notes, told_of
from .reading import Reading, first_time, seen

__all__ = ["read_usd"]
__dir__ = public_names(__name__)

# Prims that are neither lights nor shapes, and would change a picture.
_LEFT_OUT = {"RenderSettings": "render settings are left out", "Skeleton": UNPOSED}

NO_USD = "reading USD needs usd-core: pip install 'raywright[usd]'"


def read_usd(path: Path, width: int | None = None, height: int | None = None) -> RenderSetup:
    """Read a USD file: all that its stage shows at its first time.

    Parameters
    ----------
    path : Path
        The file.
    width, height : int, optional
        Size of the picture in pixels, as in `load`.

    Returns
    -------
    RenderSetup
        The stage's shapes, in the light of its own or, where it has none, of `scenes.studio`; seen by the
        first of its cameras, or framed.

    Raises
    ------
    ImportError
        If usd-core is not installed.
    FileNotFoundError
        If a file that it names is missing.
    ValueError
        If it is not a USD file that can be read, or holds nothing that is seen; the error names the prim.

    Warns
    -----
    RuntimeWarning
        Once for each kind of feature in the file that is ignored or approximated.

    Notes
    -----
    Meshes are shown as their faces are, without being subdivided. Lights give off ``intensity`` times 2 to
    the ``exposure`` as a radiance, or over their area where they are normalized.
    """
    try:
        from pxr import UsdUtils
    except ImportError as error:
        raise ImportError(NO_USD) from error

    for name, size in (("width", width), ("height", height)):
        if size is not None:
            integer(name, size, 1, 65536)
    notes = Notes(path)
    # Collects the diagnostics that USD would print.
    quiet = UsdUtils.CoalescingDiagnosticDelegate()
    try:
        shot, errors = _shot(path, notes, width, height)
        told = [" ".join(str(one.commentary).split()) for one in quiet.TakeUncoalescedDiagnostics()]
    finally:
        del quiet
    # Composition errors are reported already.
    told = [line for line in dict.fromkeys(told) if not any(error in line for error in errors)]
    if told:
        notes.tell(f"USD warns of {told[0][:200]!r}{_more(told)}")
    notes.warn()
    return shot


def _shot(path: Path, notes: Notes, width: int | None, height: int | None) -> tuple[RenderSetup, list[str]]:
    """Return the shot of a file, and the errors of composing its stage."""
    from pxr import Tf, Usd, UsdGeom

    try:
        stage = Usd.Stage.Open(str(path))
    except Tf.ErrorException as error:
        raise refused(path, "USD file", ValueError("its stage cannot be opened")) from error
    errors = _composed(stage, path, notes)
    up: Literal["y", "z"] = "z" if UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.z else "y"
    reading = Reading(first_time(stage), notes)
    try:
        found, eye = _read(stage, reading)
        shapes_of = found["shape"]
        if not shapes_of:
            raise ValueError("it has nothing visible" + _why(stage, reading))
        shot = shown(shapes_of, found["light"], eye, up=up, width=width, height=height)
        around = found["around"]
        if found["light"] or around or any(getattr(one, "emission", None) is not None for one in shapes_of):
            # The scene has its own light; emitting shapes other than meshes count, too.
            sky = around[0] if len(around) == 1 else around or None
            shot = RenderSetup(Scene(shapes_of, found["light"], sky), shot.camera)
    except (ImportError, MemoryError, FileNotFoundError):
        raise
    except Exception as error:
        raise refused(path, "USD file", error) from error
    return shot, errors


def _read(stage: Any, reading: Reading) -> tuple[dict[str, list[Any]], AnyCamera | None]:
    """Return shapes, lights and environment, and the first camera."""
    from pxr import UsdGeom

    found: dict[str, list[Any]] = {"shape": [], "light": [], "around": []}
    prims = list(seen(stage.GetPseudoRoot(), reading))
    cameras = [prim for prim in prims if prim.IsA(UsdGeom.Camera)]
    if len(cameras) > 1:
        reading.notes.tell(f"the first of its {len(cameras)} cameras is taken")
    eye = None
    for prim in cameras[:1]:
        with told_of(prim):
            eye, reading.exposure = camera(prim, reading), exposure(prim, reading)
    for prim in prims:
        with told_of(prim):
            if is_light(prim):
                if (made := light(prim, reading)) is not None:
                    found[made.kind].append(made.thing)
            elif (told := _LEFT_OUT.get(str(prim.GetTypeName()))) is not None:
                reading.notes.tell(told)
            else:
                found["shape"] += placed(prim, reading, reading.matrix(prim))
    return found, eye


def _why(stage: Any, reading: Reading) -> str:
    """Return the reasons for an empty stage: everything that was left out."""
    reasons = [
        f"{count} {'prims are' if count > 1 else 'prim is'} {why}" for why, count in reading.unseen.items()
    ]
    reasons += reading.notes.told
    if not reasons:
        types = Counter(str(prim.GetTypeName()) or "no type" for prim in stage.TraverseAll())
        reasons = [f"{count} of {name}" for name, count in sorted(types.items())]
        return f": its prims are {', '.join(reasons)}" if reasons else ": it has no prims"
    return ": " + "; ".join(reasons)


def _composed(stage: Any, path: Path, notes: Notes) -> list[str]:
    """Note and return the composition errors of a stage; refuse a stage with a missing file."""
    kinds: dict[str, list[str]] = {}
    for error in stage.GetCompositionErrors():
        line = " ".join(str(error).split())
        if "AssetPath" in type(error).__name__ or "SublayerPath" in type(error).__name__:
            name = line.partition("@")[2].partition("@")[0]
            if name and not (path.parent / name).exists():
                raise FileNotFoundError(errno.ENOENT, "no such file", str(path.parent / name))
        kinds.setdefault(type(error).__name__, []).append(line)
    for lines in kinds.values():
        notes.tell(f"it is not composed as specified: {lines[0].partition(': ')[0][:200]}{_more(lines)}")
    return [line[:60] for lines in kinds.values() for line in lines]


def _more(lines: list[str]) -> str:
    return f", and {len(lines) - 1} more of the kind" if len(lines) > 1 else ""
