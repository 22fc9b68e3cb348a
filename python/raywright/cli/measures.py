"""``raywright sky``, ``thickness``, ``visibility`` and ``lidar``: `raywright.measure` for mesh files."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..descriptions import changed
from ..io.pictures import check_writable
from ..materials import Diffuse
from ..mesh_files.meshes import load
from ..query.surface_points import SurfacePoints
from ..scene.scene import Scene
from ..shapes.joined import joined
from ..shapes.mesh import Mesh
from .options import finite, number
from .places import Sites, of_faces, of_file, of_vertices
from .tables import SUFFIXES, write

_UP = {"y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
_RAYS = 256
_MESH = "any mesh file: PLY, OBJ, STL, GLB, ..."


def add(verbs: Any) -> None:
    """Add the verbs to a parser."""
    sky = verbs.add_parser(
        "sky",
        help="sky view factor of faces, vertices or points",
        epilog="example: raywright sky city.obj --up z --points ground.csv --normal 0 0 1 -o sky.csv",
    )
    sky.set_defaults(run=_sky)
    _add_sites(sky)
    sky.add_argument(
        "--up", choices=tuple(_UP), help="zenith; there is no sky below its horizon (default: none)"
    )
    _add_rays(sky)

    thickness = verbs.add_parser(
        "thickness",
        help="thickness of a body at faces, vertices or points",
        epilog="example: raywright thickness part.stl --method sphere -o part.ply",
    )
    thickness.set_defaults(run=_thickness)
    _add_sites(thickness)
    thickness.add_argument(
        "--method",
        choices=("ray", "sphere"),
        default="ray",
        help="along the inward normal, or by the largest ball inside (default: %(default)s)",
    )
    _add_threads(thickness)

    visibility = verbs.add_parser(
        "visibility",
        help="ambient visibility of faces, vertices or points, or visibility from one point",
        description="Without --from: 1 minus ambient occlusion. With --from: 1 if visible, otherwise 0.",
        epilog="example: raywright visibility statue.ply --at vertices --radius 0.5 -o statue_ao.ply",
    )
    visibility.set_defaults(run=_visibility)
    _add_sites(visibility)
    visibility.add_argument(
        "--radius",
        metavar="R",
        type=number(float),
        help="maximum distance of occluders (default: none)",
    )
    visibility.add_argument(
        "--from", dest="viewer", nargs=3, metavar=("X", "Y", "Z"), type=finite, help="point to see from"
    )
    _add_rays(visibility)
    _add_lidar(verbs)


def _add_lidar(verbs: Any) -> None:
    told = " (default: %(default)s)"
    verb = verbs.add_parser(
        "lidar",
        help="point cloud of a simulated laser scanner",
        epilog="example: raywright lidar street.obj --position 0 1.8 0 --beams 32 --noise 0.02 -o scan.ply",
    )
    verb.set_defaults(run=_lidar)
    _add_mesh(verb)
    three = {"nargs": 3, "metavar": ("X", "Y", "Z"), "type": finite}
    verb.add_argument(
        "--position", **three, default=(0.0, 0.0, 0.0), help="position of the scanner (default: 0 0 0)"
    )
    verb.add_argument(
        "--forward", **three, help="direction of azimuth 0 (default: 1 0 0)", default=(1.0, 0.0, 0.0)
    )
    verb.add_argument("--up", choices=tuple(_UP), default="y", help="axis of rotation" + told)
    whole = number(int, 1, 10**6)
    verb.add_argument(
        "--beams", metavar="N", type=whole, default=16, help="number of beams, one above the other" + told
    )
    verb.add_argument(
        "--columns", metavar="N", type=whole, default=1800, help="number of columns of a turn" + told
    )
    verb.add_argument(
        "--elevations",
        nargs=2,
        metavar=("LOW", "HIGH"),
        type=finite,
        default=(-15.0, 15.0),
        help="elevation of the lowest and the highest beam, in degrees (default: -15 15)",
    )
    verb.add_argument(
        "--min-range", metavar="R", type=number(float, 0), default=0.0, help="minimum range" + told
    )
    verb.add_argument("--max-range", metavar="R", type=number(float), help="maximum range (default: none)")
    verb.add_argument(
        "--divergence",
        metavar="D",
        type=number(float, 0),
        default=0.0,
        help="full angle of a beam in degrees" + told,
    )
    verb.add_argument(
        "--returns",
        choices=("all", "first", "last", "strongest"),
        default="all",
        help="returns of a beam to keep" + told,
    )
    verb.add_argument(
        "--noise", metavar="S", type=number(float, 0), default=0.0, help="standard deviation of ranges" + told
    )
    verb.add_argument(
        "--dropout",
        metavar="P",
        type=number(float, 0, 1),
        default=0.0,
        help="share of returns that are lost" + told,
    )
    _add_seed(verb)
    _add_threads(verb)


def _add_mesh(verb: argparse.ArgumentParser) -> None:
    verb.set_defaults(refuse=verb.error)
    verb.add_argument("mesh", metavar="MESH", help=_MESH)
    verb.add_argument(
        "-o", "--output", metavar="FILE", help=f"{', '.join(SUFFIXES)} (default: CSV to standard output)"
    )
    verb.add_argument("--quiet", action="store_true", help="print nothing but results and errors")


def _add_sites(verb: argparse.ArgumentParser) -> None:
    _add_mesh(verb)
    where = verb.add_mutually_exclusive_group()
    where.add_argument(
        "--at",
        choices=("faces", "vertices"),
        default="faces",
        help="centers of faces, or vertices (default: %(default)s)",
    )
    where.add_argument(
        "--points",
        metavar="FILE",
        help="file of points: .csv with columns x, y, z, optionally nx, ny, nz; or .npy, (N, 3) or (N, 6)",
    )
    verb.add_argument(
        "--normal",
        nargs=3,
        metavar=("X", "Y", "Z"),
        type=finite,
        help="normal of all points (default: from the file, or from the nearest faces)",
    )
    verb.add_argument(
        "--offset",
        metavar="D",
        type=number(float, 0),
        help="distance of ray origins from the points (default: just beyond rounding)",
    )


def _add_rays(verb: argparse.ArgumentParser) -> None:
    verb.add_argument(
        "--rays",
        metavar="N",
        type=number(int, 16, 2**24),
        default=_RAYS,
        help="rays from each point (default: %(default)s)",
    )
    _add_seed(verb)
    _add_threads(verb)


def _add_seed(verb: argparse.ArgumentParser) -> None:
    verb.add_argument(
        "--seed", metavar="N", type=number(int, 0, 2**64 - 1), default=0, help="seed (default: 0)"
    )


def _add_threads(verb: argparse.ArgumentParser) -> None:
    verb.add_argument("--threads", metavar="N", type=number(int, 1), help="threads (default: all cores)")


def _sky(options: argparse.Namespace) -> None:
    from ..measure import sky_view

    up = None if options.up is None else _UP[options.up]
    _sampled(options, "sky view factor", partial(sky_view, up=up))


def _visibility(options: argparse.Namespace) -> None:
    from ..measure import ambient_visibility

    if options.viewer is not None:
        if options.radius is not None:
            options.refuse("argument --radius: not allowed with argument --from")
        _measured(options, "visibility", partial(_seen, options.viewer))
        return
    _sampled(options, "visibility", partial(ambient_visibility, radius=options.radius))


def _seen(
    viewer: Sequence[float],
    scene: Scene,
    points: Any,
    normals: Any = None,
    offset: float | None = None,
    progress: Any = None,
    threads: int | None = None,
) -> dict[str, NDArray[Any]]:
    """Return which points are seen from a place, and how far away they are."""
    from ..measure import line_of_sight

    where = points.position if isinstance(points, SurfacePoints) else points
    if offset:
        where = where + offset * normals / np.linalg.norm(normals, axis=1, keepdims=True)
    found = line_of_sight(scene, viewer, where, threads=threads)
    return {"value": found.visible.astype(np.float64), "distance": found.distance}


def _sampled(options: argparse.Namespace, what: str, measure: Callable[..., Any]) -> None:
    _measured(options, what, partial(measure, rays=options.rays, seed=options.seed))


def _thickness(options: argparse.Namespace) -> None:
    from ..measure import thickness

    _measured(options, "thickness", partial(thickness, method=options.method))


def _measured(options: argparse.Namespace, what: str, measure: Callable[..., Any]) -> None:
    """Measure where the options say, and write it."""
    output = _output(options)
    if options.normal is not None and options.points is None:
        options.refuse("argument --normal: only allowed with --points")
    if options.normal is not None and not any(options.normal):
        options.refuse("argument --normal: must not be zero, got 0 0 0")
    mesh = _mesh(options.mesh)
    scene = Scene(mesh).welded()
    sites = _sites(options, mesh, scene)
    known = sites.known
    how = {"threads": options.threads, "progress": False if options.quiet else None}
    if sites.exact is not None and options.offset is None:
        where: tuple[Any, ...] = (scene, sites.exact)
        found = _columns(measure(*where, **how))
    else:
        where = scene, sites.position[known], sites.normal[known]
        some = _columns(measure(*where, offset=options.offset, **how))
        found = {name: np.full(len(known), np.nan) for name in some}
        for name, column in some.items():
            found[name][known] = column
    columns = dict(zip("xyz", sites.position.T, strict=True)) | found
    write(output, columns, found["value"], _valued(mesh, sites, found, options))
    if not options.quiet and output is not None:
        _tell(what, found, output)


def _columns(result: Any) -> dict[str, NDArray[Any]]:
    if isinstance(result, dict):
        return result
    return {"value": result} if isinstance(result, np.ndarray) else result.to_dict()


def _sites(options: argparse.Namespace, mesh: Mesh, scene: Scene) -> Sites:
    if options.points is None:
        return of_faces(scene) if options.at == "faces" else of_vertices(mesh)
    try:
        return of_file(Path(options.points), scene, options.normal)
    except ValueError as error:
        options.refuse(f"argument --points: {error}")
        raise


def _valued(mesh: Mesh, sites: Sites, found: dict[str, NDArray[Any]], options: argparse.Namespace) -> Mesh:
    """Return the mesh with the results as attributes, or the points alone."""
    if options.points is not None:
        return Mesh(sites.position, [], vertex_attributes=found)
    of_faces, of_vertices = dict(mesh.face_attributes), dict(mesh.vertex_attributes)
    (of_faces if options.at == "faces" else of_vertices).update(found)
    return Mesh(
        mesh.vertices,
        mesh.faces,
        mesh.normals,
        mesh.uv,
        vertex_attributes=of_vertices,
        face_attributes=of_faces,
        cells=mesh.cells,
    )


def _lidar(options: argparse.Namespace) -> None:
    from ..measure import SpinningLidar, lidar

    output = _output(options)
    low, high = options.elevations
    limits = {} if options.max_range is None else {"max_range": options.max_range}
    scene = Scene(_mesh(options.mesh))
    try:
        scanner = SpinningLidar(
            elevations=np.linspace(low, high, options.beams) if options.beams > 1 else [(low + high) / 2],
            columns=options.columns,
            position=tuple(options.position),
            forward=tuple(options.forward),
            up=_UP[options.up],
            min_range=options.min_range,
            divergence=options.divergence,
            **limits,
        )
        scan = lidar(
            scene,
            scanner,
            options.returns,
            options.noise,
            dropout=options.dropout,
            seed=options.seed,
            progress=False if options.quiet else None,
            threads=options.threads,
        )
    except ValueError as error:
        options.refuse(str(error))
        raise
    columns = scan.to_dict()
    values = {name: column for name, column in columns.items() if name not in "xyz"}
    first = dict(zip("xyz", scan.position.T, strict=True))
    write(output, first | values, scan.position, Mesh(scan.position, [], vertex_attributes=values))
    if not options.quiet and output is not None:
        print(f"{len(scan)} returns of {scan.count.size} beams\nfile: {output}")


def _output(options: argparse.Namespace) -> Path | None:
    """Return where results go, having found out that they can."""
    if options.output in (None, "-"):
        return None
    try:
        return check_writable(options.output, SUFFIXES, "a result")
    except ValueError as error:
        options.refuse(f"argument -o/--output: {error}")
        raise


def _mesh(path: str) -> Mesh:
    """Return all of a file as one mesh, whatever its materials."""
    meshes = [changed(mesh, material=Diffuse(), emission=None) for mesh in load(path)]
    return joined(meshes) if len(meshes) > 1 else meshes[0]


def _tell(what: str, found: dict[str, NDArray[Any]], output: Path) -> None:
    value = found["value"]
    known = value[~np.isnan(value)]
    told = f"{what} of {len(value)}"
    if len(known):
        told += f": least {known.min():.6g}, median {np.median(known):.6g}, largest {known.max():.6g}"
    if "standard_error" in found and len(known):
        told += f"; standard error up to {np.nanmax(found['standard_error']):.2g}"
    print(told)
    if len(known) < len(value):
        lost = f"{len(value) - len(known)} of {len(value)} have no normal, and no value"
        print(f"raywright: warning: {lost}", file=sys.stderr)
    print(f"file: {output}")
