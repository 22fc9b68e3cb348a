"""The shell command: ``raywright demo``, ``render``, ``view``, ``info`` and ``report``."""

import argparse
import os
import sys
import warnings
from collections.abc import Callable, Sequence
from typing import Any, NoReturn

from ._core import VERSION
from .accelerators import Accelerator, every
from .io.pictures import SUFFIXES, check_writable
from .io.tone import DEFAULT, TONES, check_tone
from .materials import Diffuse
from .rendering.image import Image
from .rendering.render import BACKGROUNDS
from .rendering.shot import Shot
from .scene.scene import Scene
from .scene.summary import described
from .scene_files.load import has_camera, load
from .scene_files.shown import HEIGHT, WIDTH, size_of
from .scenes import cornell_box, torus_knot
from .viewer import view

# As shells count it: 128 and the number of SIGINT.
INTERRUPTED = 130
DEMO_SECONDS = 10.0
# What stands for the library's own Cornell box where a mesh file could.
CORNELL = "cornell"
# What options and arguments of a render have the same names for.
_HOW = ("samples", "error", "seconds", "seed", "threads", "adaptive", "clamp")
_SCENES = "a scene (Mitsuba's XML, glTF), or any mesh file: PLY, OBJ, STL, ..."


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the shell command and return its exit status: 0, 1 if it failed, 2 if it was used wrongly.

    Errors are one line on stderr. Ctrl-C gives 130.

    Parameters
    ----------
    arguments : sequence of str, optional
        What follows the command's name; those of the process if not given.
    """
    warnings.showwarning = _show_warning
    try:
        options = _parser().parse_args(arguments)
        options.run(options)
        sys.stdout.flush()
    except KeyboardInterrupt:
        return _fail("interrupted", INTERRUPTED)
    except BrokenPipeError:
        # Whoever read our output has left; say nothing more, not even when stdout is closed at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except MemoryError:
        return _fail("out of memory")
    except (OSError, ValueError, ImportError, RuntimeError) as error:
        return _fail(_told(error))
    return 0


def _demo(options: argparse.Namespace) -> None:
    check_writable(options.output)
    if options.samples is options.error is options.seconds is None:
        options.seconds = DEMO_SECONDS
    knot = torus_knot(material=Diffuse((0.78, 0.55, 0.2)))
    # Brighter and whiter than the box's own light, so that the picture needs no exposure.
    scene, camera = cornell_box(knot, options.width, options.height, emission=(40.0, 33.0, 22.0))
    _picture(Shot(scene, camera), options)


def _render(options: argparse.Namespace) -> None:
    check_writable(options.output)
    _picture(_shot(options), options)


def _view(options: argparse.Namespace) -> None:
    shot = _shot(options)
    own: dict[str, Any] = {"integrator": shot.integrator, "sampler": shot.sampler, "filter": shot.filter}
    how = _how(options, shot)
    look = {"exposure": options.exposure, "tone": options.tone}
    with view(shot.scene, shot.camera, **own, **how, **look, port=options.port, open=options.open) as viewer:
        print(f"{viewer.url}\n(Ctrl-C ends it)", flush=True)
        viewer.wait()


def _info(options: argparse.Namespace) -> None:
    whole = has_camera(options.scene)
    scene = load(options.scene).scene if whole else Scene(options.scene)
    print(described(str(options.scene), scene))


def _report_accelerators(options: argparse.Namespace) -> None:
    # Reports are for those who ask for them: other verbs do not wait for their import.
    from .report import accelerators
    from .report.ray_sets import outside

    _check_plot(options)
    scene = Scene(options.mesh)
    camera = outside(scene, max(round(options.rays**0.5), 1))
    report = accelerators(
        scene, camera, options.accelerators, options.threads, options.repeats, seed=options.seed
    )
    _tell_report(report, options)


def _report_convergence(options: argparse.Namespace) -> None:
    from .report import convergence

    _check_plot(options)
    shot = _shot(options)
    report = convergence(
        shot.scene,
        shot.camera,
        seconds=options.seconds,
        reference=options.reference,
        seeds=options.seeds,
        threads=options.threads,
    )
    _tell_report(report, options)


def _shot(options: argparse.Namespace) -> Shot:
    """Return what SCENE names: what a file holds as it is shown, or the Cornell box."""
    if options.up is not None and (options.scene == CORNELL or has_camera(options.scene)):
        options.refuse(f"argument --up: is for mesh files, and {options.scene} knows itself what is up")
    if options.scene == CORNELL:
        return Shot(*cornell_box(None, *size_of(options.width, options.height)))
    return load(options.scene, options.up or "y", options.width, options.height)


def _how(options: argparse.Namespace, shot: Shot) -> dict[str, Any]:
    """Return what options say of a render."""
    how = {name: getattr(options, name) for name in _HOW}
    own = {"seed": shot.seed, "clamp": shot.clamp}
    return how | {name: value for name, value in own.items() if how[name] is None}


def _check_plot(options: argparse.Namespace) -> None:
    from .report.plots import NO_MATPLOTLIB

    if options.plot is not None:
        check_writable(options.plot, (".png",), "a plot")
        try:
            import matplotlib  # noqa: F401
        except ImportError as error:
            raise ImportError(NO_MATPLOTLIB) from error


def _tell_report(report: Any, options: argparse.Namespace) -> None:
    if options.form == "csv":
        print(report.csv(), end="")
    else:
        print(report.markdown() if options.form == "markdown" else report)
    if options.plot is not None:
        report.plot(options.plot)


def _picture(shot: Shot, options: argparse.Namespace) -> None:
    # What a scene hides stays hidden.
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


class _Parser(argparse.ArgumentParser):
    """One that fails in one line."""

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"raywright: error: {message} (see {self.prog} --help)\n")


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(prog="raywright", description="Trace rays and render pictures that tell their error.")
    parser.add_argument(
        "--version", action="version", version=f"raywright {VERSION}", help="tell the version and exit"
    )
    verbs = parser.add_subparsers(title="verbs", dest="verb", metavar="VERB", required=True)

    demo = verbs.add_parser("demo", help="render a Cornell box with a knot in it")
    demo.set_defaults(run=_demo)
    _add_picture(demo, "cornell.png", f"{DEMO_SECONDS:g} seconds", width=512, height=512)

    one = verbs.add_parser("render", help="render a scene, or a mesh file, which is framed and lit")
    one.set_defaults(run=_render)
    _add_scene(one)
    _add_picture(one, None, "64 samples, or as many as the scene's own file says")

    _add_view(verbs.add_parser("view", help="show a scene in the browser while it renders"))

    info = verbs.add_parser("info", help="tell what a file holds, and what its accelerator looks like")
    info.set_defaults(run=_info)
    info.add_argument("scene", metavar="SCENE", help=_SCENES)

    report = verbs.add_parser("report", help="compare what the library has for the same task")
    reports = report.add_subparsers(title="reports", dest="report", metavar="REPORT", required=True)
    _add_accelerators(
        reports.add_parser("accelerators", help="every accelerator on the same rays: costs, and if all agree")
    )
    _add_convergence(
        reports.add_parser("convergence", help="error against run time, with and without adaptive sampling")
    )
    return parser


def _add_view(verb: argparse.ArgumentParser) -> None:
    verb.set_defaults(run=_view)
    _add_scene(verb)
    verb.add_argument(
        "--port",
        metavar="N",
        type=_number(int, 0, 65535),
        default=0,
        help="where on 127.0.0.1 to serve the page (default: any that is free)",
    )
    verb.add_argument("--open", action="store_true", help="open a browser")
    _add_tone(verb)
    _add_limits(verb, "to a relMSE of 0.0001")


def _add_scene(verb: argparse.ArgumentParser) -> None:
    verb.add_argument("scene", metavar="SCENE", help=f"{_SCENES}; or {CORNELL!r}")
    verb.add_argument(
        "--up", choices=("y", "z"), help="axis that points up in a mesh file, not in a scene (default: y)"
    )
    verb.set_defaults(refuse=verb.error)


def _add_accelerators(report: argparse.ArgumentParser) -> None:
    told = " (default: %(default)s)"
    report.set_defaults(run=_report_accelerators)
    report.add_argument("mesh", metavar="MESH", help="any mesh file: PLY, OBJ, STL, GLB, ...")
    report.add_argument(
        "--accelerators",
        metavar="NAMES",
        type=_accelerators,
        help="which, with commas between: names as the report has them, or kinds such as BVH (default: all)",
    )
    report.add_argument(
        "--rays",
        metavar="N",
        type=_number(int, 1, 2**31 - 1),
        default=65536,
        help="about how many primary rays: as many as make a square" + told,
    )
    report.add_argument("--threads", metavar="N", type=_number(int, 1), default=1, help="threads" + told)
    report.add_argument(
        "--repeats", metavar="N", type=_number(int, 1, 10_000), default=5, help="turns of each" + told
    )
    report.add_argument("--seed", metavar="N", type=_number(int, 0, 2**64 - 1), default=0, help="seed" + told)
    _add_forms(report)


def _add_convergence(report: argparse.ArgumentParser) -> None:
    told = " (default: %(default)s)"
    report.set_defaults(run=_report_convergence)
    _add_scene(report)
    report.add_argument(
        "--seconds",
        metavar="S",
        type=_number(float),
        default=4.0,
        help="longest run time of one render" + told,
    )
    report.add_argument(
        "--reference",
        metavar="S",
        type=_number(float),
        help="seconds to make a reference in (default: errors are as estimated)",
    )
    report.add_argument(
        "--seeds", metavar="N", type=_number(int, 1, 10_000), default=3, help="renders of each" + told
    )
    size = _number(int, 1, 65536)
    report.add_argument("--width", metavar="W", type=size, default=256, help="pixels" + told)
    report.add_argument("--height", metavar="H", type=size, default=256, help="pixels" + told)
    report.add_argument("--threads", metavar="N", type=_number(int, 1), help="threads (default: all cores)")
    _add_forms(report)


def _add_forms(report: argparse.ArgumentParser) -> None:
    forms = report.add_mutually_exclusive_group()
    forms.add_argument(
        "--csv", dest="form", action="store_const", const="csv", default="table", help="print CSV, all digits"
    )
    forms.add_argument(
        "--markdown", dest="form", action="store_const", const="markdown", help="print Markdown"
    )
    report.add_argument("--plot", metavar="FILE", help="save a plot, .png")


def _accelerators(text: str) -> dict[str, Accelerator]:
    """Read names of accelerators, or of kinds of them."""
    known = every()
    found: dict[str, Accelerator] = {}
    for name in (part.strip() for part in text.split(",")):
        mine = {
            key: one
            for key, one in known.items()
            if name.lower() in (key.lower(), type(one).__name__.lower())
        }
        if not mine:
            raise argparse.ArgumentTypeError(f"{name!r} is none of: {', '.join(known)}")
        found.update(mine)
    return found


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
        help="whether the camera sees it, or the picture has an alpha instead" + told,
    )
    _add_limits(verb, limit, width, height)
    verb.add_argument(
        "--checkpoint", metavar="FILE", help="keep the render in a file, and go on from it if it is there"
    )
    verb.add_argument(
        "--denoise", action="store_true", help="take the noise out in the end: biased, with its error"
    )
    verb.add_argument("--quiet", action="store_true", help="print nothing but errors")


def _add_tone(verb: argparse.ArgumentParser) -> None:
    """Add how pictures are shown."""
    told = " (default: %(default)s)"
    verb.add_argument(
        "--exposure",
        metavar="E",
        type=_stops,
        default=0.0,
        help="stops by which pictures for the eye are made brighter" + told,
    )
    verb.add_argument(
        "--tone", choices=TONES, default=DEFAULT, help="how what is brighter than white is shown" + told
    )


def _add_limits(
    verb: argparse.ArgumentParser, limit: str, width: int | None = None, height: int | None = None
) -> None:
    """Add when a render ends, and how it is done."""
    told = " (default: %(default)s)"
    limits = verb.add_argument_group(
        "limits", f"The first that is met ends the render. Without any: {limit}."
    )
    limits.add_argument("--samples", metavar="N", type=_number(int, 1, 2**32 - 1), help="samples a pixel")
    limits.add_argument("--error", metavar="E", type=_number(float), help="estimated relMSE of the picture")
    limits.add_argument("--seconds", metavar="S", type=_number(float), help="run time")
    size = _number(int, 1, 65536)
    own = f" (default: the scene's own, and of a mesh file {WIDTH} x {HEIGHT})"
    for name, letter, default in (("width", "W", width), ("height", "H", height)):
        told_size = told if default is not None else own
        verb.add_argument(f"--{name}", metavar=letter, type=size, default=default, help="pixels" + told_size)
    verb.add_argument("--threads", metavar="N", type=_number(int, 1), help="threads (default: all cores)")
    verb.add_argument(
        "--seed", metavar="N", type=_number(int, 0, 2**64 - 1), help="seed (default: the scene's own, or 0)"
    )
    verb.add_argument(
        "--adaptive", action="store_true", help="more samples where more of the estimated error is"
    )
    verb.add_argument(
        "--clamp", metavar="L", type=_number(float), help="radiance to dim brighter samples to: biased"
    )


def _number(kind: type[Any], least: int | None = None, most: int | None = None) -> Callable[[str], Any]:
    """Read a number in least..most; without `least`, one above 0 and finite."""

    def read(text: str) -> Any:
        value = kind(text)
        if least is None:
            if not 0 < value < float("inf"):
                raise argparse.ArgumentTypeError(f"must be greater than 0, got {text}")
        elif value < least or (most is not None and value > most):
            limits = f"at least {least}" if most is None else f"between {least} and {most}"
            raise argparse.ArgumentTypeError(f"must be {limits}, got {text}")
        return value

    # argparse names the function in "invalid ... value".
    read.__name__ = "whole number" if kind is int else "number"
    return read


def _stops(text: str) -> float:
    """Read an exposure."""
    try:
        return check_tone(float(text), DEFAULT)
    except ValueError:
        message = f"must be a number between -100 and 100, got {text}"
        raise argparse.ArgumentTypeError(message) from None


def _told(error: Exception) -> str:
    """Tell an error in one line; the system's own begin with a number that says nothing to most."""
    if isinstance(error, OSError) and error.strerror:
        told = error.strerror[:1].lower() + error.strerror[1:]
        return f"{error.filename}: {told}" if error.filename is not None else told
    return " ".join(str(error).split()) or type(error).__name__


def _fail(message: str, status: int = 1) -> int:
    print(f"raywright: error: {message}" if status == 1 else f"raywright: {message}", file=sys.stderr)
    return status


def _show_warning(message: Warning | str, *_: Any, **__: Any) -> None:
    print(f"raywright: warning: {message}", file=sys.stderr)
