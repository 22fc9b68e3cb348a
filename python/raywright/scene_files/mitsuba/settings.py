"""Integrators, samplers and reconstruction filters."""

from collections.abc import Callable
from typing import NamedTuple

from ...integrators import AmbientOcclusion, AnyIntegrator, Direct, LightTraced, Path
from ...rendering.filters import (
    BoxFilter,
    Filter,
    GaussianFilter,
    LanczosFilter,
    MitchellFilter,
    TriangleFilter,
)
from ...rendering.samplers import Independent, Sampler, Sobol, Stratified
from .plugin import Plugin

# Among media or not, and forwards, these are path tracing all the same.
_PATHS = ("path", "volpath", "volpathmis", "prb", "prb_basic", "prbvolpath")
INTEGRATORS = (*_PATHS, "ptracer", "direct", "ao", "aov")
SAMPLERS = ("independent", "stratified", "multijitter", "orthogonal", "ldsampler")
FILTERS = ("box", "tent", "gaussian", "mitchell", "catmullrom", "lanczos")

_AOVS = {
    "depth": "depth",
    "position": "position",
    "uv": "uv",
    "geo_normal": "normal",
    "sh_normal": "shading_normal",
    "shape_index": "shape_id",
    "prim_index": "primitive",
    "albedo": "albedo",
}


class Asked(NamedTuple):
    """What an integrator asks for: how light is found, and what else is seen."""

    integrator: AnyIntegrator
    aov: tuple[str, ...] = ()


def integrator(plugin: Plugin | None) -> Asked:
    """Return what an integrator asks for; of a scene without one, light along paths.

    Raises
    ------
    ValueError
        If its type, or a parameter of it, is not supported; tells which.
    """
    if plugin is None:
        return Asked(Path())
    plugin.ignore("timeout", "block_size", "samples_per_pass", "use_spectral_mis")
    if plugin.type == "aov":
        result = _aov(plugin)
    else:
        if plugin.switch("hide_emitters", False):
            plugin.warn("hide_emitters is left out: what shines is seen")
        if plugin.type == "direct":
            result = Asked(_direct(plugin))
        elif plugin.type == "ao":
            radius = plugin.number("ray_length", -1.0)
            samples = plugin.integer("shading_samples", 1)
            result = Asked(AmbientOcclusion(radius if radius > 0 else float("inf"), samples=samples))
        elif plugin.type == "ptracer":
            result = Asked(LightTraced(*_depths(plugin)))
        else:
            result = Asked(Path(*_depths(plugin)))
    plugin.done()
    return result


def _depths(plugin: Plugin) -> tuple[int | None, int]:
    # Mitsuba counts what is seen as the first: at a depth of 1 there are emitters only.
    depth, roulette = plugin.integer("max_depth", -1), plugin.integer("rr_depth", 5)
    if depth == 0 or depth < -1 or roulette < 1:
        plugin.fail(
            f"max_depth must be -1 or at least 1, and rr_depth at least 1, got {depth} and {roulette}"
        )
    return None if depth < 0 else depth - 1, roulette - 1


def _direct(plugin: Plugin) -> AnyIntegrator:
    both = plugin.integer("shading_samples", 1)
    light, surface = (plugin.integer(f"{name}_samples", both) for name in ("emitter", "bsdf"))
    if light < 1 or surface < 1:
        plugin.fail("emitter_samples and bsdf_samples must be at least 1")
    return Direct(light, surface)


def _aov(plugin: Plugin) -> Asked:
    inner = [integrator(one) for one in plugin.children(*INTEGRATORS)]
    if len(inner) > 1:
        plugin.fail("one integrator at most can be within")
    names = []
    for part in filter(None, (part.strip() for part in plugin.text("aovs").split(","))):
        kind = part.rpartition(":")[2].strip()
        if kind not in _AOVS:
            plugin.fail(f"aovs must be of {', '.join(_AOVS)}, got {kind!r}")
        names.append(_AOVS[kind])
    light, more = inner[0] if inner else Asked(Path(0))
    return Asked(light, tuple(dict.fromkeys([*names, *more])))


def sampler(plugin: Plugin | None) -> tuple[Sampler | None, int, int]:
    """Return a sampler if one is named, how many samples a pixel it takes, and its seed."""
    if plugin is None:
        return None, 4, 0
    kinds: dict[str, Sampler] = {"independent": Independent(), "ldsampler": Sobol()}
    plugin.ignore("jitter", "strength")
    count, seed = plugin.integer("sample_count", 4), plugin.integer("seed", 0)
    plugin.done()
    if count < 1 or seed < 0:
        plugin.fail(f"sample_count must be at least 1 and seed at least 0, got {count} and {seed}")
    return kinds.get(plugin.type, Stratified()), count, seed


def rfilter(plugin: Plugin | None) -> Filter:
    """Return a reconstruction filter; Mitsuba's own, a Gaussian, if there is none."""
    if plugin is None:
        return GaussianFilter(2.0, 0.5)
    readers: dict[str, Callable[[Plugin], Filter]] = {
        "box": lambda _: BoxFilter(),
        "tent": lambda one: TriangleFilter(one.number("radius", 1.0)),
        "gaussian": _gaussian,
        "mitchell": lambda one: MitchellFilter(2.0, one.number("B", 1 / 3), one.number("C", 1 / 3)),
        "catmullrom": lambda _: MitchellFilter(2.0, 0.0, 0.5),
        "lanczos": lambda one: LanczosFilter(one.integer("lobes", 3)),
    }
    result = readers[plugin.type](plugin)
    plugin.done()
    return result


def _gaussian(plugin: Plugin) -> GaussianFilter:
    deviation = plugin.number("stddev", 0.5)
    return GaussianFilter(4 * deviation, deviation)
