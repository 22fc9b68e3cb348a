"""Table of Mitsuba's plugins: supported, approximated or refused.

``python docs/mitsuba_plugins.py --write`` puts the table into ``docs/from_mitsuba.md``; a test checks that it
is current. Supported plugins are read from the reader itself; this file lists the others.
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
    "textures and colors": (*textures.TYPES, *values.UNIFORM),
    "emitters": ("area", *emitters.TYPES),
    "sensors": sensors.TYPES,
    "films": sensors.FILMS,
    "filters": settings.FILTERS,
    "samplers": settings.SAMPLERS,
    "integrators": settings.INTEGRATORS,
    "media": (*media.TYPES, *media.PHASES, *media.VOLUMES),
}
# Approximated, and how.
NEARLY = {
    "linearcurve": "a mesh of 48 sides, within 0.22 % of the radius; fewer sides beyond 4 million triangles",
    "bsplinecurve": "likewise, in straight pieces within 0.1 % of the radius; the ends are open",
    "sdfgrid": "a mesh of a third of its cells, with corners on the surface",
    "heightfield": "Mitsuba 0.6's: a mesh of four triangles per patch, with the points of the picture",
    "mesh_attribute": "PLY files only: vertices or faces, one attribute a mesh, between 0 and 1",
    "volume": "grids on meshes, quartered until edges are half a cell or there are 4 million triangles",
    "bumpmap": "slopes are means over a thousandth of the coordinates",
    "spot": "with a texture: a projector of up to 2048² points, fall-off included",
    "projector": "a texture's picture is resampled to 512 points or more",
    "envmap": "rows are spaced evenly between the poles, half a row off at most",
    "sunsky": "the sky of Preetham et al. (1999), which is brighter than Hosek's and Wilkie's; warns",
    "perspective": "`near_clip` and `far_clip` are ignored",
    "distant": "towards a point",
    "ldrfilm": "as `hdrfilm`",
    "independent": "as Mitsuba's default: chosen automatically; `load(path, sampler=)` sets one",
    "hammersley": "as `halton`",
    "volpath": "as `path`",
    "volpathmis": "as `path`",
    "prb": "as `path`",
    "prb_basic": "as `path`",
    "prbvolpath": "as `path`",
    "moment": "the nested integrator; every picture has an error estimate",
    "direct": "if `emitter_samples` or `bsdf_samples` is 0, the other technique samples all light; "
    "with a warning",
    "gridvolume": "one or three channels; all grids of a medium in the same place",
    "depth": '`aov="depth"`',
}
# Refused by name.
REFUSED = {
    "shapes": ("ellipsoids", "ellipsoidsmesh"),
    "BSDFs": (
        "circular", "hair", "measured", "measured_polarized", "polarizer", "pplastic", "retarder",
    ),
    "textures and colors": (),
    "emitters": ("directionalarea", "timed_sunsky"),
    "sensors": ("batch", "irradiancemeter"),
    "films": ("specfilm",),
    "filters": (),
    "samplers": (),
    "integrators": ("stokes", "volprim_rf_basic"),
    "media": ("sggx",),
}  # fmt: skip


def table() -> str:
    """Return the table in Markdown."""
    lines = ["| Mitsuba | support | plugins, or approximation |", "|---|---|---|"]
    for kind in REFUSED:
        names = dict.fromkeys(READ.get(kind, ()))
        rows = [(name, "approximated" if name in NEARLY else "supported") for name in names]
        supported = ", ".join(f"`{name}`" for name, what in rows if what == "supported")
        if supported:
            lines.append(f"| {kind} | supported | {supported} |")
        lines += [f"| `{name}` | {what} | {NEARLY[name]} |" for name, what in rows if what != "supported"]
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
