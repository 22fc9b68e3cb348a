"""``raywright report``."""

from __future__ import annotations

import argparse
from typing import Any

from ..accelerators import Accelerator, every
from ..io.pictures import check_writable
from ..scene.scene import Scene
from .options import number
from .pictures import add_scene, shot_of


def add(verbs: Any) -> None:
    """Add the verb to a parser."""
    report = verbs.add_parser("report", help="compare accelerators, or integrator settings")
    reports = report.add_subparsers(title="reports", dest="report", metavar="REPORT", required=True)
    _add_accelerators(
        reports.add_parser(
            "accelerators", help="every accelerator on the same rays: cost, and agreement of hits"
        )
    )
    _add_convergence(
        reports.add_parser("convergence", help="error against run time, with and without adaptive sampling")
    )


def _report_accelerators(options: argparse.Namespace) -> None:
    # Imported here, because only this verb needs reports (import time).
    from ..report import accelerators
    from ..report.ray_sets import outside

    _check_plot(options)
    scene = Scene(options.mesh)
    camera = outside(scene, max(round(options.rays**0.5), 1))
    report = accelerators(
        scene, camera, options.accelerators, options.threads, options.repeats, seed=options.seed
    )
    _tell_report(report, options)


def _report_convergence(options: argparse.Namespace) -> None:
    from ..report import convergence

    _check_plot(options)
    shot = shot_of(options)
    report = convergence(
        shot.scene,
        shot.camera,
        seconds=options.seconds,
        reference=options.reference,
        seeds=options.seeds,
        threads=options.threads,
    )
    _tell_report(report, options)


def _check_plot(options: argparse.Namespace) -> None:
    from ..io.plots import NO_MATPLOTLIB

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


def _add_accelerators(report: argparse.ArgumentParser) -> None:
    told = " (default: %(default)s)"
    report.set_defaults(run=_report_accelerators)
    report.add_argument("mesh", metavar="MESH", help="any mesh file: PLY, OBJ, STL, GLB, ...")
    report.add_argument(
        "--accelerators",
        metavar="NAMES",
        type=_accelerators,
        help="accelerators, separated by commas: names from the report, or kinds such as BVH (default: all)",
    )
    report.add_argument(
        "--rays",
        metavar="N",
        type=number(int, 1, 2**31 - 1),
        default=65536,
        help="approximate number of primary rays, rounded to a square picture" + told,
    )
    report.add_argument("--threads", metavar="N", type=number(int, 1), default=1, help="threads" + told)
    report.add_argument(
        "--repeats",
        metavar="N",
        type=number(int, 1, 10_000),
        default=5,
        help="number of timings of each" + told,
    )
    report.add_argument("--seed", metavar="N", type=number(int, 0, 2**64 - 1), default=0, help="seed" + told)
    _add_forms(report)


def _add_convergence(report: argparse.ArgumentParser) -> None:
    told = " (default: %(default)s)"
    report.set_defaults(run=_report_convergence)
    add_scene(report)
    report.add_argument(
        "--seconds",
        metavar="S",
        type=number(float),
        default=4.0,
        help="longest run time of a render, in seconds" + told,
    )
    report.add_argument(
        "--reference",
        metavar="S",
        type=number(float),
        help="time for a reference, in seconds (default: none; errors are estimates)",
    )
    report.add_argument(
        "--seeds",
        metavar="N",
        type=number(int, 1, 10_000),
        default=3,
        help="number of renders of each" + told,
    )
    size = number(int, 1, 65536)
    report.add_argument("--width", metavar="W", type=size, default=256, help="pixels" + told)
    report.add_argument("--height", metavar="H", type=size, default=256, help="pixels" + told)
    report.add_argument("--threads", metavar="N", type=number(int, 1), help="threads (default: all cores)")
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
            raise argparse.ArgumentTypeError(f"{name!r} is not one of: {', '.join(known)}")
        found.update(mine)
    return found
