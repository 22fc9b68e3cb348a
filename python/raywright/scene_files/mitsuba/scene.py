"""A whole scene, from a dict or an XML file."""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from ...arrays import integer
from ...lights import Environment, Light
from ...rendering.render_setup import RenderSetup
from ...scene.scene import Scene
from ...shapes.welding import Weld, weld_tolerance
from . import bsdfs, emitters, media, sensors, settings, shapes, textures
from .errors import SceneError
from .plugin import Context, Plugin
from .xml import read_xml

# Plugins that serve as targets of references, and are read there.
_SHARED = (
    "area",
    *bsdfs.TYPES,
    *media.TYPES,
    "null",
    *textures.TYPES,
    shapes.GROUP,
    *settings.SAMPLERS,
    *settings.FILTERS,
    *sensors.FILMS,
    "alias",
)


# Numeric problems of file contents are reported otherwise.
@np.errstate(all="ignore")
def from_mitsuba(
    scene: Mapping[str, Any] | str | PathLike[str],
    *,
    folder: str | PathLike[str] | None = None,
    sensor: int = 0,
    parameters: Mapping[str, Any] | None = None,
    weld: Weld = "auto",
) -> RenderSetup:
    """Read a scene in the format of Mitsuba 3.

    The picture is that of Mitsuba's ``_rgb`` variants. Unsupported plugins are refused by name; approximated
    ones give a warning, once for each type.

    Parameters
    ----------
    scene : dict or path
        A scene as ``mitsuba.load_dict`` takes it, or an XML file. Transforms may be nested lists, arrays, or
        Mitsuba's own objects; Mitsuba is not needed.
    folder : path, optional
        Folder of the files of a dict; the current one if not given. Files of an XML scene are searched beside
        it, then in this folder.
    sensor : int
        Index of the sensor to use.
    parameters : dict, optional
        Values of ``$name`` in an XML file, in place of its defaults: numbers, texts or bools by name.
    weld : "auto", float or None
        Welding distance of corners of meshes, as in `load`.

    Returns
    -------
    RenderSetup
        The scene, with its camera, integrator and settings.

    Raises
    ------
    FileNotFoundError
        If a file is missing.
    ValueError
        If something is not supported, or is malformed (the error gives plugin or line), or `weld` is negative
        or not finite.
    TypeError
        If `scene` is neither a dict nor a path, or `sensor` is not an integer.

    See Also
    --------
    load : Reads files of all kinds.

    Examples
    --------
    >>> ball = {"type": "sphere", "bsdf": {"type": "diffuse"}}
    >>> lamp = {"type": "constant"}
    >>> shot = rw.from_mitsuba({"type": "scene", "ball": ball, "lamp": lamp, "view": {"type": "perspective"}})
    >>> shot.scene.shapes[0].radius, type(shot.scene.environment).__name__
    (1.0, 'ConstantEnvironment')
    """
    sensor = integer("sensor", sensor, 0)
    weld_tolerance(weld)
    if isinstance(scene, Mapping):
        if parameters:
            raise ValueError("parameters are for XML files; a dict has none")
        tree, folders = scene, [Path("." if folder is None else folder)]
    elif isinstance(scene, str | PathLike):
        tree, folders = read_xml(Path(scene), parameters or {}, None if folder is None else Path(folder))
    else:
        raise TypeError(f"scene must be a dict or a path, got {type(scene).__name__}")
    if tree.get("type") != "scene":
        raise SceneError(f"scene must have the type 'scene', got {tree.get('type')!r}")
    try:
        return _read(Plugin(tree, "", Context(tree, folders)), sensor, weld)
    except SceneError as error:
        if isinstance(scene, Mapping) or str(scene) in str(error):
            raise
        raise SceneError(f"{scene}: {error}") from error


def _read(scene: Plugin, number: int, weld: Weld) -> RenderSetup:
    found: list[Any] = []
    copies = shapes.Copies()
    lights: list[Light] = []
    around: list[Environment] = []
    for plugin in scene.children(*shapes.TYPES, shapes.COPY, shapes.MERGED, *emitters.TYPES):
        if plugin.type == shapes.COPY:
            copies.add(plugin, found)
        elif plugin.type == shapes.MERGED:
            found += shapes.group(plugin)
        elif plugin.type in emitters.TYPES:
            one = emitters.emitter(plugin)
            if isinstance(one, Light):
                lights.append(one)
            else:
                around.append(one)
        else:
            found += shapes.shapes_of(plugin)
    integrators = list(scene.children(*settings.INTEGRATORS))
    if len(integrators) > 1:
        scene.fail("a scene must have one integrator only")
    looking = list(scene.children(*sensors.TYPES))
    for other in scene.children(*sensors.OTHERS):
        scene.fail(f"{other} is not supported here; sensors are {', '.join(sensors.TYPES)}")
    for _ in scene.children(*_SHARED):
        pass
    scene.done()
    if not looking:
        scene.fail("it has no sensor")
    if not 0 <= number < len(looking):
        scene.fail(f"there is no sensor {number}: it has {len(looking)}")
    eye = looking[number]
    asked = settings.integrator(integrators[0] if integrators else None)
    if asked.hidden and any(shapes.shines(one) for one in found):
        integrators[0].warn("hide_emitters hides environments only: emissive surfaces stay visible")
    if asked.unaimed:
        # No ray hits a light without extent.
        lights = []
    film = _only(eye, *sensors.FILMS)
    has_border = film is not None and film.switch("sample_border", False)
    rfilter = settings.rfilter(_only(film, *settings.FILTERS) if film is not None else None, has_border)
    sampling = settings.sampler(_only(eye, *settings.SAMPLERS))
    whole = Scene(
        shapes.instances(found),
        lights,
        around[0] if len(around) == 1 else around or None,
        medium=media.around(scene, eye),
        shading_normals="raw",
        weld=weld,
    ).welded()
    return RenderSetup(
        whole,
        sensors.camera(eye, film, whole),
        asked.integrator,
        sampling.samples,
        sampler=sampling.sampler,
        filter=rfilter,
        seed=sampling.seed,
        aov=asked.aov,
        background="transparent" if asked.hidden else "shown",
        unnamed=sampling.unnamed,
    )


def _only(plugin: Plugin, *types: str) -> Plugin | None:
    found = list(plugin.children(*types))
    if len(found) > 1:
        plugin.fail(f"only one {found[0].type} can be within")
    return found[0] if found else None
