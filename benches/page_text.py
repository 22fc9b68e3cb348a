"""The page of benchmarks, as Markdown, from the records of its sections."""

import statistics

import points
import stress
from peers_tables import fastest, head, line

_HEAD = """# Benchmarks

raywright beside other engines on one machine. `python benches/benchmarks_page.py` measures all of it in
about five minutes and writes this page; each section has its date and machine, and its figures are in
`docs/benchmarks/`. On your machine, the same scripts print more: `benches/peers.py`, `stress.py`,
`small_calls.py`, `points.py`, `view_factors.py` and `render_peers.py`.
"""

_TITLES = {
    "rays": "Rays",
    "wrong": "Wrong answers",
    "builds": "Builds and memory",
    "distances": "Closest points and signed distances",
    "factors": "View factors",
    "pictures": "Pictures",
}

_TEXTS = {
    "rays": """Millions of rays a second, from numpy arrays to numpy arrays. Each engine takes turns with
raywright, and the last columns are the median ratio of those turns: raywright's speed over that of the
fastest other engine. embreex, Open3D and Mitsuba use Embree, with its widest instructions. embreex runs in
its robust mode, and has one thread; Mitsuba is timed with and without its flag for coherent rays, and the
faster time is shown.""",
    "wrong": """Wrong answers per million rays that are hard for float32 arithmetic: a hit instead of a miss,
the reverse, or another surface. Exact rational arithmetic gives the truth. All input is float32, so
each engine has the same scene. "embreex" and
"open3d" are Embree's robust mode; "embreex fast" and "mitsuba" are not. [Why raywright has
none](architecture/exactness.md).""",
    "builds": """Seconds from arrays to a compiled scene, on all cores, and memory growth of a fresh process
for each triangle, in bytes. The mesh is a torus with a rough surface.""",
    "distances": """Points a second on all cores: half of the points are near the surface, half anywhere in
1.5 times its box. trimesh gets a hundredth of the points; libigl builds its tree in each call. The column
"differs by" is the largest difference over the mesh's size.""",
    "factors": """All view factors between the faces of a cubic room, empty and with a block in it. Rows add
up to 1 in a closed room; "rows within" is the largest deviation. Errors of rows are standard errors of the
pairs by rays. pyViewFactor computes the empty room from squares, raywright from twice as many triangles.""",
    "pictures": """Error against time: relMSE, the mean of (x - ref)² / (ref² + 0.01), against a long picture
of the same engine, by the number of samples a pixel. For Mitsuba the sampler with the least error times
time is shown. raywright chooses its own options.""",
}


def page(sections):
    """Return the page, given by section what its file holds, or None where it has not been measured."""
    parts = [_HEAD]
    for name, title in _TITLES.items():
        parts.append(f"## {title}\n\n{' '.join(_TEXTS[name].split())}\n")
        found = sections.get(name)
        if found is None:
            parts.append(f"Not measured yet: `python benches/benchmarks_page.py --section {name}`.\n")
            continue
        parts.append(f"*{_told(found)}*\n")
        # Tables of several levels name raywright's own.
        level = [found["machine"]["simd"]] if name == "rays" else []
        parts.append(_TABLES[name](found["records"], *level) + "\n")
        if name in ("rays", "pictures"):
            parts.append(f"![{title}](benchmarks/{name}.svg)\n")
    return "\n".join(parts)


def _told(found):
    m = found["machine"]
    return (
        f"{found['date']}, {m['processor']}, {m['cores']} cores, {m['memory_gib']:.0f} GiB, {m['system']}, "
        f"Python {m['python']}, raywright {m['raywright']} at {m['simd']}, load {m['load']:.2f} before."
    )


def _rays(records, simd):
    tables = []
    for threads in dict.fromkeys(r["on_threads"] for r in records):
        own = [r for r in records if r["on_threads"] == threads]
        names = [n for n in dict.fromkeys(r["engine"] for r in own) if n != "raywright"]
        is_both = "raywright avx2" in names
        faster = ["faster by"] + ["avx2 faster by"] * is_both
        rows = [head(["mesh: rays", "hit", f"raywright {simd}", *names, *faster])]
        for mesh, rays in dict.fromkeys((r["mesh"], r["rays"]) for r in own):
            here = [r for r in own if (r["mesh"], r["rays"]) == (mesh, rays)]
            best = {name: fastest(r for r in here if r["engine"] == name) for name in names}
            peer = min((r["ratio"] for n, r in best.items() if not n.startswith("raywright")), default=None)
            ratios = ["-" if peer is None else f"{peer:.2f}"]
            if is_both:
                ratios.append("-" if peer is None else f"{peer / best['raywright avx2']['ratio']:.2f}")
            speed = statistics.median(r["raywright_mrays"] for r in here)
            cells = [f"{best[name]['mrays_per_second']:.1f}" for name in names]
            rows.append(
                line([f"{mesh}: {rays}", f"{100 * here[0]['hit']:.0f} %", f"{speed:.1f}", *cells, *ratios])
            )
        tables.append(f"On {threads} {'thread' if threads == 1 else 'threads'}:\n\n" + "\n".join(rows))
    return "\n\n".join(tables)


def _builds(records):
    rows = [head(["triangles", "engine", "version", "build, s", "bytes a triangle"])]
    for r in records:
        size = "-" if r["bytes_per_triangle"] is None else f"{r['bytes_per_triangle']:.0f}"
        rows.append(
            line([f"{r['triangles']:,}", r["engine"], r["version"], f"{r['build_seconds']:.3f}", size])
        )
    return "\n".join(rows)


def _factors(records):
    own, peers = ([r for r in records if (key in r)] for key in ("room", "peer_seconds"))
    rows = [head(["room", "triangles", "seconds", "rays", "rows within", "errors of rows"])]
    for r in own:
        off, error = f"{r['rows_off']:.0e}", f"{r['error_of_rows']:.0e}" if r["error_of_rows"] else "exact"
        rows.append(
            line([r["room"], f"{r['triangles']:,}", f"{r['seconds']:.2f}", f"{r['rays']:,}", off, error])
        )
    text = "\n".join(rows)
    if peers:
        rows = [
            head(
                [
                    "squares",
                    "pyViewFactor, s",
                    "raywright, s",
                    "faster",
                    "rows within",
                    "raywright's",
                    "apart by",
                ]
            )
        ]
        for r in peers:
            faster = f"{r['peer_seconds'] / r['raywright_seconds']:.0f}"
            numbers = (r[key] for key in ("peer_rows_off", "raywright_rows_off", "greatest_difference"))
            seconds = f"{r['peer_seconds']:.1f}", f"{r['raywright_seconds']:.2f}"
            rows.append(line([str(r["squares"]), *seconds, faster, *(f"{x:.0e}" for x in numbers)]))
        text += "\n\n" + "\n".join(rows)
    return text


def shown_pictures(records):
    """Return by scene the curves that are shown: raywright's, and that of the best sampler of Mitsuba."""
    shown = {}
    for scene in dict.fromkeys(r["scene"] for r in records):
        of = [r for r in records if r["scene"] == scene]
        costs = {}
        for r in of:
            costs.setdefault(r["engine"], []).append(r["seconds"] * max(r["relmse"], 1e-12))
        mitsuba = [name for name in costs if name.startswith("mitsuba")]
        best = min(mitsuba, key=lambda name: costs[name][-1], default=None)
        chosen = [name for name in costs if name == best or name not in mitsuba]
        shown[scene] = {name: [r for r in of if r["engine"] == name] for name in chosen}
    return shown


def _pictures(records):
    rows = [head(["scene", "engine", "samples", "seconds", "relMSE"])]
    for scene, curves in shown_pictures(records).items():
        for name, curve in curves.items():
            for r in curve:
                rows.append(
                    line([scene, name, str(r["samples"]), f"{r['seconds']:.3f}", f"{r['relmse']:.1e}"])
                )
    return "\n".join(rows)


_TABLES = {
    "rays": _rays,
    "wrong": stress.table,
    "builds": _builds,
    "distances": points.table,
    "factors": _factors,
    "pictures": _pictures,
}
