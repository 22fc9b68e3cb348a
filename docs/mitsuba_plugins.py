"""Mitsuba's plugins, one by one, and what becomes of each here.

``python docs/mitsuba_plugins.py --write`` puts the table into ``docs/from_mitsuba.md``; a test checks that it
is current. What is read is asked of the reader itself; what is approximated or refused is told here.
"""

import re
import sys
from pathlib import Path

from raywright.scene_files.mitsuba import bsdfs, emitters, media, sensors, settings, shapes, textures, values

PAGE = Path(__file__).parent / "from_mitsuba.md"
BEGIN, END = "<!-- plugins -->\n", "<!-- plugins end -->\n"

READ = {
    "shapes": (*shapes.TYPES, shapes.GROUP, shapes.COPY, shapes.MERGED),
    "BSDFs": (*bsdfs.TYPES, "null"),
    "textures and colours": (*textures.TYPES, *values.UNIFORM),
    "emitters": ("area", *emitters.TYPES),
    "sensors": sensors.TYPES,
    "films": sensors.FILMS,
    "filters": settings.FILTERS,
    "samplers": settings.SAMPLERS,
    "integrators": settings.INTEGRATORS,
    "media": (*media.TYPES, *media.PHASES, *media.VOLUMES),
}
# What is another thing here, or not quite the same.
NEARLY = {
    "linearcurve": "a mesh of 48 sides, within 0.22 % of the radius; fewer sides beyond 4 million triangles",
    "bsplinecurve": "so too, in straight pieces that stray by 0.1 % of the radius; one sees into open ends",
    "sdfgrid": "a mesh of a third of its cells, with corners on the surface",
    "heightfield": "Mitsuba 0.6's: a mesh of four triangles a patch, whose points are those of the picture",
    "mesh_attribute": "of PLY files: vertices or faces, one attribute a mesh, between 0 and 1",
    "volume": "a grid: of meshes, quartered until edges are half a cell or there are 4 million triangles",
    "bumpmap": "slopes are means over a thousandth of the coordinates",
    "spot": "with a texture: a projector of up to 2048² points, in which the fall-off is",
    "projector": "a texture's picture is resampled to 512 points or more",
    "envmap": "rows lie evenly between the poles, half a row off at most",
    "sunsky": "the sky of Preetham et al. (1999), which is brighter than Hosek's and Wilkie's; warned of",
    "perspective": "`near_clip` and `far_clip` are left out",
    "distant": "towards a point",
    "ldrfilm": "as `hdrfilm`",
    "independent": "as Mitsuba's default: none is named; `load(path, sampler=)` overrules",
    "hammersley": "as `halton`",
    "volpath": "as `path`",
    "volpathmis": "as `path`",
    "prb": "as `path`",
    "prb_basic": "as `path`",
    "prbvolpath": "as `path`",
    "moment": "the integrator within, whose error every picture tells",
    "direct": "with none of `emitter_samples` or `bsdf_samples`: the same light by the other; warned of",
    "gridvolume": "of one or three channels; those of a medium in the same place",
    "depth": '`aov="depth"`',
}
# What is not read, and is refused by its name.
REFUSED = {
    "shapes": ("ellipsoids", "ellipsoidsmesh"),
    "BSDFs": (
        "circular", "hair", "measured", "measured_polarized", "polarizer", "pplastic", "retarder",
    ),
    "textures and colours": (),
    "emitters": ("directionalarea", "timed_sunsky"),
    "sensors": ("batch", "irradiancemeter"),
    "films": ("specfilm",),
    "filters": (),
    "samplers": (),
    "integrators": ("stokes", "volprim_rf_basic"),
    "media": ("sggx",),
}  # fmt: skip


def table() -> str:
    """Return the table as a page has it."""
    lines = ["| Mitsuba | | |", "|---|---|---|"]
    for kind in REFUSED:
        rows = [
            (name, "approximated" if name in NEARLY else "had") for name in dict.fromkeys(READ.get(kind, ()))
        ]
        had = ", ".join(f"`{name}`" for name, what in rows if what == "had")
        if had:
            lines.append(f"| {kind} | had | {had} |")
        lines += [f"| `{name}` | {what} | {NEARLY[name]} |" for name, what in rows if what != "had"]
        if REFUSED[kind]:
            lines.append(f"| {kind} | refused | {', '.join(f'`{name}`' for name in REFUSED[kind])} |")
    return "\n".join(lines) + "\n"


def written(page: str) -> str:
    """Return the page with the table in it."""
    return re.sub(f"{BEGIN}.*?{END}", lambda _: BEGIN + "\n" + table() + "\n" + END, page, flags=re.DOTALL)


if __name__ == "__main__":
    if sys.argv[1:] != ["--write"]:
        sys.exit(__doc__)
    PAGE.write_text(written(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
