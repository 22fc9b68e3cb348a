"""The plots of the page of benchmarks, as small SVG files whose bytes depend on the figures alone."""

import statistics

from page_text import shown_pictures
from peers_tables import counted, fastest

_COLORS = {
    "raywright": "#c0392b",
    "raywright avx2": "#e59866",
    "embreex": "#2471a3",
    "open3d": "#1e8449",
    "mitsuba": "#7d3c98",
}


def _pyplot():
    import matplotlib

    matplotlib.use("Agg")
    matplotlib.rcParams.update({"svg.hashsalt": "raywright", "svg.fonttype": "none", "font.size": 9})
    import matplotlib.pyplot as plt

    return plt


def _saved(figure, path):
    figure.savefig(path, metadata={"Date": None}, bbox_inches="tight")
    path.write_text("\n".join(text.rstrip() for text in path.read_text().splitlines()) + "\n")


def rays(records, path):
    """Plot Mrays/s of each engine: rows of meshes and rays, a panel for each number of threads."""
    plt = _pyplot()
    rows = list(dict.fromkeys((r["mesh"], r["rays"]) for r in records))
    counts = list(dict.fromkeys(r["on_threads"] for r in records))
    height = 0.22 * len(rows) + 1
    figure, every = plt.subplots(
        1, len(counts), figsize=(2 + 3 * len(counts), height), sharey=True, squeeze=False
    )
    for threads, axes in zip(counts, every[0], strict=True):
        for engine in _COLORS:
            where, speeds = [], []
            for at, row in enumerate(rows):
                here = [r for r in records if r["on_threads"] == threads and (r["mesh"], r["rays"]) == row]
                speed = _speed(here, engine)
                if speed is not None:
                    where.append(at)
                    speeds.append(speed)
            axes.plot(
                speeds, where, "o", color=_COLORS[engine], label=engine if speeds else None, markersize=5
            )
        axes.set_xlim(left=0)
        axes.set_xlabel(f"Mrays/s on {counted(threads, 'thread')}")
        axes.grid(alpha=0.3)
    every[0][0].set_yticks(range(len(rows)), [f"{mesh}: {kind}" for mesh, kind in rows])
    every[0][0].invert_yaxis()
    handles, labels = every[0][0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", bbox_to_anchor=(0.5, 0.92), ncols=5, frameon=False)
    _saved(figure, path)
    plt.close(figure)


def _speed(records, engine):
    """Return the Mrays/s of an engine; those of raywright are of the turns beside all others."""
    if engine == "raywright":
        return statistics.median(r["raywright_mrays"] for r in records)
    own = [r for r in records if r["engine"] == engine]
    return fastest(own)["mrays_per_second"] if own else None


def pictures(records, path):
    """Plot error against time of each engine, scene by scene."""
    plt = _pyplot()
    shown = shown_pictures(records)
    figure, every = plt.subplots(1, len(shown), figsize=(2.9 * len(shown), 2.7), squeeze=False)
    for (scene, curves), axes in zip(shown.items(), every[0], strict=True):
        for name, curve in curves.items():
            good = [r for r in curve if r["relmse"] > 0]
            seconds, errors = [r["seconds"] for r in good], [r["relmse"] for r in good]
            axes.loglog(seconds, errors, "o-", color=_COLORS[name.split()[0]], label=name, markersize=4)
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_minor_formatter(plt.NullFormatter())
        axes.set_title(scene)
        axes.set_xlabel("seconds")
        axes.grid(alpha=0.3)
        axes.legend(frameon=False, fontsize=7)
    every[0][0].set_ylabel("relMSE")
    figure.tight_layout()
    _saved(figure, path)
    plt.close(figure)


PLOTS = {"rays": rays, "pictures": pictures}
