"""What Mitsuba's spectral variants make of metals in white light.

``python tests/python/materials/mitsuba_metals.py --write``, where Mitsuba 3 is installed, looks at a plate
of each
metal that it knows under white ``rgb`` light, and writes the means and standard errors of red, green and blue
to ``data/mitsuba_metals.txt``, which the tests compare with. Names after it are those of the metals to look
at; the others stay as they are.
"""

import sys
from importlib.metadata import version
from pathlib import Path
from typing import NamedTuple

import numpy as np

REFERENCES = Path(__file__).parents[1] / "data" / "mitsuba_metals.txt"
# Mitsuba's names that are not the symbol.
NAMES = {"Na": "Na_palik", "Ni": "Ni_palik", "V": "V_palik"}
# Metals known to both.
METALS = (
    *("Ag", "Al", "Au", "Be", "Cr", "Cu", "Hg", "Ir", "K", "Li", "Mo", "Na", "Nb", "Ni", "Rh", "Ta"),
    *("TiC", "TiN", "V", "VC", "VN", "W"),
)
SIZE, SAMPLES = 64, 256


class View(NamedTuple):
    """How a plate is lit and looked at."""

    # Under a white sky, or a light in the mirror direction.
    light: str
    # 0 is smooth; GGX.
    alpha: float
    # From the normal, in degrees.
    angle: float


SMOOTH = tuple(View("sky", 0.0, angle) for angle in (0, 45, 70, 85))
ROUGH = tuple(View("mirrored", alpha, angle) for alpha in (0.05, 0.15) for angle in (0, 60))
VIEWS = SMOOTH + ROUGH


def by_mitsuba(symbol, view, seed=0, samples=SAMPLES):
    """Mean and standard error of what is seen, by Mitsuba."""
    import mitsuba as mi

    if mi.variant() is None:
        mi.set_variant("scalar_spectral")
    # From straight above, Mitsuba's lithium, carbides and nitrides are NaN.
    angle = np.radians(max(view.angle, 0.5))
    eye, light = (np.array([sign * np.sin(angle), 0, np.cos(angle)]) for sign in (1, -1))
    white = {"type": "rgb", "value": 1.0}
    if view.light == "sky":
        lamp = {"type": "constant", "radiance": white}
    else:
        lamp = {"type": "directional", "direction": list(-light), "irradiance": white}
    metal = {"type": "conductor"}
    if view.alpha:
        metal = {"type": "roughconductor", "alpha": view.alpha, "distribution": "ggx"}
    look = mi.ScalarTransform4f().look_at(origin=list(10 * eye), target=[0, 0, 0], up=[0, 1, 0])
    film = {"type": "hdrfilm", "width": SIZE, "height": SIZE, "component_format": "float32"}
    plate = mi.load_dict(
        {
            "type": "scene",
            "integrator": {"type": "path", "max_depth": 2},
            "sensor": {
                "type": "orthographic",
                "to_world": look @ mi.ScalarTransform4f().scale(0.01),
                "film": {**film, "rfilter": {"type": "box"}},
            },
            "plate": {"type": "rectangle", "bsdf": {**metal, "material": NAMES.get(symbol, symbol)}},
            "lamp": lamp,
        }
    )
    pixels = np.array(mi.render(plate, spp=samples, seed=seed), np.float64)[..., :3].reshape(-1, 3)
    return pixels.mean(axis=0), pixels.std(axis=0, ddof=1) / np.sqrt(len(pixels))


def references():
    """Yield symbol, view, mean and standard error of all that was looked at."""
    for line in REFERENCES.read_text().splitlines():
        if not line.startswith("#"):
            symbol, light, *numbers = line.split()
            alpha, angle, *colors = map(float, numbers)
            yield symbol, View(light, alpha, angle), np.array(colors[:3]), np.array(colors[3:])


def write(names):
    """Look at metals by Mitsuba and write the references; at all of them if none is named."""
    kept = {}
    if REFERENCES.exists() and names:
        kept = {(symbol, view): colors for symbol, view, *colors in references()}
    for symbol in names or METALS:
        for view in VIEWS:
            kept[symbol, view] = by_mitsuba(symbol, view)
        print(symbol, flush=True)
        lines = [
            f"# By Mitsuba {version('mitsuba')}: python tests/python/materials/mitsuba_metals.py --write\n"
        ]
        lines.append("# Metal, light, alpha, angle; red, green, blue, and their standard errors.\n")
        for (metal, view), (mean, error) in sorted(kept.items()):
            colors = " ".join([*(f"{x:.5f}" for x in mean), *(f"{x:.1e}" for x in error)])
            lines.append(f"{metal} {view.light} {view.alpha:g} {view.angle:g} {colors}\n")
        REFERENCES.write_text("".join(lines))


if __name__ == "__main__":
    if sys.argv[1:2] != ["--write"]:
        sys.exit(__doc__)
    write(sys.argv[2:])
