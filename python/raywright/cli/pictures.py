"""``raywright demo``, ``render`` and ``view``."""

from __future__ import annotations

import argparse
from typing import Any

from ..io.pictures import SUFFIXES, check_writable
from ..io.tone import DEFAULT, TONES, check_tone
from ..materials import Diffuse
from ..rendering.check_request import BACKGROUNDS
from ..rendering.image import Image
from ..rendering.render_setup import RenderSetup
from ..scene_files.load import has_camera, load
from ..scene_files.shown import HEIGHT, WIDTH, size_of
from ..scenes import cornell_box, torus_knot
from ..viewer import view
from .options import number

DEMO_SECONDS = 10.0
# Stands for the library's own Cornell box in place of a mesh file.
CORNELL = "cornell"
SCENES = "a scene (Mitsuba's XML, glTF), or any mesh file: PLY, OBJ, STL, ..."
# Options of the command line and arguments of `render` that share a name.
_HOW = ("samples", "error", "seconds", "seed", "threads", "adaptive", "clamp")


def add(verbs: Any) -> None:
    """Add the verbs to a parser."""
    demo = verbs.add_parser("demo", help="render a Cornell box with a knot in it")
    demo.set_defaults(run=_demo)
    _add_picture(demo, "cornell.png", f"{DEMO_SECONDS:g} seconds", width=512, height=512)

    one = verbs.add_parser("render", help="render a scene file, or a mesh file framed and lit")
    one.set_defaults(run=_render)
    add_scene(one)
    _add_picture(one, None, "64 samples, or as many as the scene's own file says")

    _add_view(verbs.add_parser("view", help="show a scene in the browser while it renders"))


def _demo(options: argparse.Namespace) -> None:
    check_writable(options.output)
    if options.samples is options.error is options.seconds is None:
        options.seconds = DEMO_SECONDS
    knot = torus_knot(material=Diffuse((0.78, 0.55, 0.2)))
    # Brighter and whiter than the box's own light, so that the picture needs no exposure.
    scene, camera = cornell_box(knot, options.width, options.height, emission=(40.0, 33.0, 22.0))
    _picture(RenderSetup(scene, camera), options)


def _render(options: argparse.Namespace) -> None:
    check_writable(options.output)
    _picture(shot_of(options), options)


def _view(options: argparse.Namespace) -> None:
    shot = shot_of(options)
    own: dict[str, Any] = {"integrator": shot.integrator, "sampler": shot.sampler, "filter": shot.filter}
    how = _how(options, shot)
    look = {"exposure": options.exposure, "tone": options.tone}
    with view(shot.scene, shot.camera, **own, **how, **look, port=options.port, open=options.open) as viewer:
        print(f"{viewer.url}\n(Ctrl-C ends it)", flush=True)
        viewer.wait()


def shot_of(options: argparse.Namespace) -> RenderSetup:
    """Return the shot of SCENE: a file, or the Cornell box."""
    if options.up is not None and (options.scene == CORNELL or has_camera(options.scene)):
        options.refuse(f"argument --up: only allowed for mesh files, and {options.scene} defines its own up")
    if options.scene == CORNELL:
        return RenderSetup(*cornell_box(None, *size_of(options.width, options.height)))
    return load(options.scene, options.up or "y", options.width, options.height)


def _how(options: argparse.Namespace, shot: RenderSetup) -> dict[str, Any]:
    """Return the arguments of a render from the options."""
    how = {name: getattr(options, name) for name in _HOW}
    own = {"seed": shot.seed, "clamp": shot.clamp}
    return how | {name: value for name, value in own.items() if how[name] is None}


def _picture(shot: RenderSetup, options: argparse.Namespace) -> None:
    # A background hidden by the scene stays hidden.
    background = shot.background if options.background == BACKGROUNDS[0] else options.background
    kept = {"checkpoint": options.checkpoint, "background": background, "denoise": options.denoise}
    image = shot.render(**_how(options, shot), **kept, progress=not options.quiet)
    image.save(options.output, options.exposure, options.tone)
    if not options.quiet:
        _tell(image, options.output)


def _tell(image: Image, path: str) -> None:
    print("error against time")
    print(image.table())
    print(f"relMSE {image.error} after {image.samples} samples a pixel in {image.seconds:.1f} s")
    for warning in image.warnings:
        print(f"warning: {warning}")
    print(f"picture: {path}")


def _add_view(verb: argparse.ArgumentParser) -> None:
    verb.set_defaults(run=_view)
    add_scene(verb)
    verb.add_argument(
        "--port",
        metavar="N",
        type=number(int, 0, 65535),
        default=0,
        help="port of the page on 127.0.0.1 (default: any free port)",
    )
    verb.add_argument("--open", action="store_true", help="open a browser")
    _add_tone(verb)
    _add_limits(verb, "to a relMSE of 0.0001")


def add_scene(verb: argparse.ArgumentParser) -> None:
    """Add the argument of a scene."""
    verb.add_argument("scene", metavar="SCENE", help=f"{SCENES}; or {CORNELL!r}")
    verb.add_argument(
        "--up", choices=("y", "z"), help="up axis of a mesh file; scene files have their own (default: y)"
    )
    verb.set_defaults(refuse=verb.error)


def _add_picture(
    verb: argparse.ArgumentParser,
    output: str | None,
    limit: str,
    width: int | None = None,
    height: int | None = None,
) -> None:
    told = " (default: %(default)s)"
    verb.add_argument(
        "-o",
        "--output",
        metavar="FILE",
        required=output is None,
        default=output,
        help=f"{', '.join(SUFFIXES)}" + (told if output else ""),
    )
    _add_tone(verb)
    verb.add_argument(
        "--background",
        choices=BACKGROUNDS,
        default=BACKGROUNDS[0],
        help="show the environment, or make the background transparent" + told,
    )
    _add_limits(verb, limit, width, height)
    verb.add_argument(
        "--checkpoint",
        metavar="FILE",
        help="save the state of the render in FILE, and continue from it if it exists",
    )
    verb.add_argument(
        "--denoise", action="store_true", help="denoise the finished picture (biased, with an error estimate)"
    )
    verb.add_argument("--quiet", action="store_true", help="print nothing but errors")


def _add_tone(verb: argparse.ArgumentParser) -> None:
    """Add how pictures are shown."""
    told = " (default: %(default)s)"
    verb.add_argument(
        "--exposure",
        metavar="E",
        type=stops,
        default=0.0,
        help="exposure of 8-bit pictures, in stops" + told,
    )
    verb.add_argument(
        "--tone", choices=TONES, default=DEFAULT, help="tone mapping of values brighter than white" + told
    )


def _add_limits(
    verb: argparse.ArgumentParser, limit: str, width: int | None = None, height: int | None = None
) -> None:
    """Add when a render ends, and how it is done."""
    told = " (default: %(default)s)"
    limits = verb.add_argument_group(
        "limits", f"The first that is met ends the render. Without any: {limit}."
    )
    limits.add_argument("--samples", metavar="N", type=number(int, 1, 2**32 - 1), help="samples a pixel")
    limits.add_argument("--error", metavar="E", type=number(float), help="estimated relMSE of the picture")
    limits.add_argument("--seconds", metavar="S", type=number(float), help="run time")
    size = number(int, 1, 65536)
    own = f" (default: the scene's own, and of a mesh file {WIDTH} x {HEIGHT})"
    for name, letter, default in (("width", "W", width), ("height", "H", height)):
        told_size = told if default is not None else own
        verb.add_argument(f"--{name}", metavar=letter, type=size, default=default, help="pixels" + told_size)
    verb.add_argument("--threads", metavar="N", type=number(int, 1), help="threads (default: all cores)")
    verb.add_argument(
        "--seed", metavar="N", type=number(int, 0, 2**64 - 1), help="seed (default: the scene's own, or 0)"
    )
    verb.add_argument("--adaptive", action="store_true", help="take more samples for pixels with more error")
    verb.add_argument(
        "--clamp", metavar="L", type=number(float), help="maximum radiance of a sample (biased)"
    )


def stops(text: str) -> float:
    """Read an exposure."""
    try:
        return check_tone(float(text), DEFAULT)
    except ValueError:
        message = f"must be a number between -100 and 100, got {text}"
        raise argparse.ArgumentTypeError(message) from None
