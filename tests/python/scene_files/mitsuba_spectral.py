"""Small scenes in Mitsuba's format with spectra, whose pictures are those of its spectral variants."""

import numpy as np
from mitsuba_parts import FLOOR, LAMP, ball, rgb, scene


def pairs(values, first=400.0, last=700.0):
    """A spectrum of values that lie evenly."""
    nm = np.linspace(first, last, len(values))
    return {"type": "spectrum", "value": [(float(x), float(y)) for x, y in zip(nm, values, strict=True)]}


def text(values):
    return ", ".join(repr(float(x)) for x in values)


# A brick, a leaf, and a coat with two narrow reflection bands.
BRICK = pairs([0.06, 0.07, 0.08, 0.15, 0.4, 0.6, 0.65])
LEAF = {
    "type": "irregular",
    "wavelengths": text([360, 480, 520, 550, 590, 650, 680, 710, 760, 830]),
    "values": text([0.04, 0.06, 0.1, 0.3, 0.12, 0.08, 0.05, 0.3, 0.7, 0.7]),
}
BANDS = {
    "type": "regular",
    "wavelength_min": 360.0,
    "wavelength_max": 760.0,
    "values": text([0.05, 0.05, 0.8, 0.05, 0.05, 0.05, 0.9, 0.05, 0.05]),
}


def lamp(radiance):
    return {**LAMP, "emitter": {"type": "area", "radiance": radiance}}


def matt(reflectance):
    return {"type": "diffuse", "reflectance": reflectance}


def spectral():
    """Return the scenes, as dicts, by name."""
    floor = {**FLOOR, "bsdf": matt(BRICK)}
    metal = {
        "type": "roughconductor",
        "alpha": 0.3,
        "distribution": "ggx",
        "eta": pairs([1.6, 1.3, 0.9, 0.4, 0.2, 0.15, 0.14], 360.0, 830.0),
        "k": pairs([1.9, 1.8, 1.8, 2.5, 3.3, 4.0, 5.2], 360.0, 830.0),
    }
    return {
        "spectra in daylight": scene(a=floor, b=ball(matt(LEAF)), lamp=lamp({"type": "d65", "scale": 9.0})),
        "a black body": scene(
            a=floor,
            b=ball(matt(BANDS)),
            lamp=lamp({"type": "blackbody", "temperature": 2700.0}),
            sky={"type": "constant", "radiance": rgb(30.0, 45.0, 90.0)},
        ),
        "a lamp of bands": scene(
            a={**FLOOR, "bsdf": matt(rgb(0.7, 0.5, 0.3))},
            b=ball(metal),
            lamp=lamp(pairs([0.0, 9.0, 1.0, 1.0, 14.0, 0.5, 8.0])),
        ),
    }
