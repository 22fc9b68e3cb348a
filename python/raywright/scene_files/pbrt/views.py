"""Cameras, filters, samplers and integrators."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ...cameras import AnyCamera, Camera, Orthographic, Panorama, ThinLens
from ...integrators import (
    AmbientOcclusion,
    AnyIntegrator,
    Bidirectional,
    LightTraced,
    Path,
    ProgressivePhotonMap,
)
from ...rendering.filters import (
    BoxFilter,
    Filter,
    GaussianFilter,
    LanczosFilter,
    MitchellFilter,
    TriangleFilter,
)
from ...rendering.samplers import Halton, Independent, Sampler, Sobol, Stratified
from .films import exposure
from .parameters import Floats, Parameters

# Variants of path tracing with the same expected picture.
_PATHS = ("path", "volpath", "simplepath", "simplevolpath", "randomwalk", "mlt")


def camera(kind: str, parameters: Parameters, matrix: Floats, size: tuple[int, int]) -> AnyCamera:
    """Return a camera.

    Parameters
    ----------
    kind : str
        Its type.
    parameters : Parameters
        Its parameters.
    matrix : (4, 4) array
        From the camera, which looks along its +z with its +x to the right, to a world that is right-handed.
    size : tuple of 2 ints
        The width and height of the film.

    Raises
    ------
    ValueError
        If its type, or a parameter of it, is not supported; the error names it.
    """
    width, height = size
    exposure(parameters)
    for name in ("frameaspectratio", "screenwindow"):
        if parameters.has(name):
            parameters.fail(f"{name} is not supported")
    common: dict[str, Any] = {
        "direction": matrix[:3, 2] / np.linalg.norm(matrix[:3, 2]),
        "up": matrix[:3, 1] / np.linalg.norm(matrix[:3, 1]),
        "width": width,
        "height": height,
    }
    place = matrix[:3, 3]
    made: AnyCamera
    if kind == "perspective":
        lens, distance = parameters.number("lensradius", 0.0), parameters.number("focaldistance", 1e6)
        fov = parameters.number("fov", 90.0)
        if lens < 0:
            parameters.fail(f"lensradius must be at least 0, got {lens:g}")
        if lens > 0:
            made = ThinLens(
                place, fov=fov, fov_axis="smaller", aperture_radius=lens, focus_distance=distance, **common
            )
        else:
            made = Camera(place, fov=fov, fov_axis="smaller", **common)
    elif kind == "orthographic":
        parameters.leave_out("lensradius", "focaldistance")
        scale = 2 * float(np.linalg.norm(matrix[:3, 0]))
        made = Orthographic(place, scale=scale, scale_axis="smaller", **common)
    elif kind == "spherical":
        if parameters.text("mapping", "equalarea") != "equirectangular":
            parameters.fail("mapping must be equirectangular")
        made = Panorama(place, **common)
    else:
        parameters.fail(f"a camera {kind!r} is not supported")
    parameters.done()
    return made


def rfilter(kind: str, parameters: Parameters) -> Filter:
    """Return a filter."""
    default = {"box": 0.5, "gaussian": 1.5, "mitchell": 2.0, "sinc": 4.0, "triangle": 2.0}
    if kind not in default:
        parameters.fail(f"a filter {kind!r} is not supported")
    across, down = (parameters.number(f"{axis}radius", default[kind]) for axis in "xy")
    if across != down:
        parameters.fail(f"xradius and yradius must be the same, got {across:g} and {down:g}")
    made: Filter
    if kind == "box":
        made = BoxFilter(across)
    elif kind == "gaussian":
        made = GaussianFilter(across, parameters.number("sigma", 0.5))
    elif kind == "mitchell":
        made = MitchellFilter(across, parameters.number("B", 1 / 3), parameters.number("C", 1 / 3))
    elif kind == "triangle":
        made = TriangleFilter(across)
    else:
        made = LanczosFilter(max(round(across), 1))
        if parameters.number("tau", 3.0) != made.lobes or across != made.lobes:
            parameters.notes.tell(f"the sinc filter is approximated by Lanczos' of {made.lobes} lobes")
    parameters.done()
    return made


def sampler(kind: str, parameters: Parameters) -> tuple[Sampler | None, int, int]:
    """Return a sampler, None for ours, how many samples a pixel there are, and the seed."""
    kinds: dict[str, Sampler | None] = {
        "independent": Independent(),
        "stratified": Stratified(),
        "halton": Halton(),
        "sobol": Sobol(),
        "paddedsobol": Sobol(),
        "zsobol": Sobol(),
        "pmj02bn": None,
    }
    if kind not in kinds:
        parameters.fail(f"a sampler {kind!r} is not supported")
    if kind == "stratified":
        sides = parameters.integer("xsamples", 4), parameters.integer("ysamples", 4)
        count = sides[0] * sides[1] if min(sides) > 0 else 0
    else:
        count = parameters.integer("pixelsamples", 16)
    seed = parameters.integer("seed", 0)
    parameters.leave_out("jitter", "randomization")
    parameters.done()
    if count < 1 or not 0 <= seed < 2**64:
        parameters.fail(f"samples must be at least 1 and seed at least 0, got {count:g} and {seed:g}")
    return kinds[kind], count, seed


def integrator(kind: str, parameters: Parameters) -> AnyIntegrator:
    """Return an integrator."""
    depth = parameters.integer("maxdepth", 5)
    if depth < 0:
        parameters.fail(f"maxdepth must be at least 0, got {depth}")
    # Sampling parameters, which change the error but not the expectation.
    parameters.ignore(
        "lightsampler", "bootstrapsamples", "chains", "mutationsperpixel", "largestepprobability", "sigma",
        "seed", "samplelights", "samplebsdf", "photonsperiteration", "radius",
    )  # fmt: skip
    parameters.leave_out_if_true("regularize", "visualizestrategies", "visualizeweights")
    made: AnyIntegrator
    if kind in _PATHS:
        made = Path(depth)
    elif kind == "bdpt":
        made = Bidirectional(depth)
    elif kind == "lightpath":
        made = LightTraced(depth)
    elif kind == "sppm":
        # Both pbrt and raywright choose the number of photons if it is below one.
        photons = parameters.integer("photonsperiteration", -1)
        radius = parameters.number("radius", 1.0) if parameters.has("radius") else None
        made = ProgressivePhotonMap(photons if photons > 0 else None, radius, max_depth=depth)
    elif kind == "ambientocclusion":
        distance = parameters.number("maxdistance", math.inf) if parameters.has("maxdistance") else math.inf
        parameters.ignore("cossample")
        made = AmbientOcclusion(distance)
    else:
        parameters.fail(f"an integrator {kind!r} is not supported")
    parameters.done()
    return made
