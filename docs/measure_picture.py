"""Makes docs/measure.png: sky and sun of the ground between houses. Needs matplotlib."""

from pathlib import Path

import matplotlib
import numpy as np

import raywright as rw

matplotlib.use("Agg")
SIDE = 60.0
CELLS = 220


def houses(count: int = 14) -> list[rw.Box]:
    """Houses of different heights, anywhere, y up."""
    rng = np.random.default_rng(5)
    low = rng.uniform(4, SIDE - 14, (count, 2))
    size = rng.uniform(5, 11, (count, 2))
    high = rng.uniform(4, 22, count)
    return [rw.Box((x, 0, z), (x + a, h, z + b)) for (x, z), (a, b), h in zip(low, size, high, strict=True)]


def main() -> None:
    """Measure, and draw what is found from above."""
    from matplotlib import pyplot as plt

    scene = rw.Scene(houses())
    along = (np.arange(CELLS) + 0.5) / CELLS * SIDE
    x, z = np.meshgrid(along, along)
    ground = np.stack([x, np.zeros_like(x), z], axis=-1)
    built = scene.occluded(ground, (0, 1, 0))
    sky = rw.measure.sky_view(scene, ground, (0, 1, 0), rays=256)
    times = np.arange("2025-03-21T04:00", "2025-03-21T20:00", 15, dtype="datetime64[m]")
    sun = rw.measure.solar_exposure(
        scene, ground, (0, 1, 0), times=times, latitude=47.4, longitude=8.5, weights=0.25
    )
    figure, axes = plt.subplots(1, 2, figsize=(10, 4.4), dpi=100)
    for axis, values, title, colors in (
        (axes[0], sky.value, "sky view factor", "viridis"),
        (axes[1], sun.sunlit, "hours of sun", "inferno"),
    ):
        shown = axis.imshow(np.where(built, np.nan, values), cmap=colors, extent=(0, SIDE, SIDE, 0), vmin=0)
        axis.set_facecolor("0.75")
        axis.set_title(title)
        figure.colorbar(shown, ax=axis)
    figure.tight_layout()
    figure.savefig(Path(__file__).with_name("measure.png"))


if __name__ == "__main__":
    main()
