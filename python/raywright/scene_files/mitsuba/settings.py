"""Integrators, samplers and reconstruction filters."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from ...integrators import AmbientOcclusion, AnyIntegrator, Direct, LightTraced, Path
from ...rendering.filters import (
    BoxFilter,
    CroppedFilter,
    Filter,
    GaussianFilter,
    LanczosFilter,
    MitchellFilter,
    TriangleFilter,
    WholeFilter,
)
from ...rendering.samplers import Halton, Sampler, Sobol, Stratified
from .plugin import Plugin

# With or without media, and with derivatives or not, these are path tracing.
_PATHS = ("path", "volpath", "volpathmis", "prb", "prb_basic", "prbvolpath")
INTEGRATORS = (*_PATHS, "ptracer", "direct", "ao", "aov", "depth", "moment")
SAMPLERS = (
    "independent", "stratified", "multijitter", "orthogonal", "ldsampler", "sobol", "halton", "hammersley",
)  # fmt: skip
FILTERS = ("box", "tent", "gaussian", "mitchell", "catmullrom", "lanczos")

_AOVS = {
    "depth": "depth",
    "position": "position",
    "uv": "uv",
    "geo_normal": "normal",
    "sh_normal": "shading_normal",
    "shape_index": "shape_id",
    "prim_index": "primitive_id",
    "albedo": "albedo",
}


class Asked(NamedTuple):
    """Options of an integrator.

    Attributes
    ----------
    integrator : Path or another kind
        The method of light transport.
    aov : tuple of str
        Auxiliary buffers.
    hidden : bool
        True to hide emitters.
    unaimed : bool
        True without light sampling: lights without size are never found.
    """

    integrator: AnyIntegrator
    aov: tuple[str, ...] = ()
    hidden: bool = False
    unaimed: bool = False


def integrator(plugin: Plugin | None) -> Asked:
    """Return what an integrator asks for; of a scene without one, light along paths.

    Raises
    ------
    ValueError
        If its type, or a parameter of it, is not supported; the error names it.
    """
    if plugin is None:
        return Asked(Path())
    plugin.ignore("timeout", "block_size", "samples_per_pass", "use_spectral_mis")
    if plugin.type == "aov":
        result = _aov(plugin)
    elif plugin.type == "moment":
        result = _moment(plugin)
    elif plugin.type == "depth":
        result = Asked(Path(0), ("depth",))
    else:
        hidden = plugin.switch("hide_emitters", False)
        if plugin.type == "direct":
            result = _direct(plugin)
        elif plugin.type == "ao":
            radius = plugin.number("ray_length", -1.0)
            samples = plugin.integer("shading_samples", 1)
            result = Asked(AmbientOcclusion(radius if radius > 0 else float("inf"), samples=samples))
        elif plugin.type == "ptracer":
            result = Asked(LightTraced(*_depths(plugin)))
        else:
            result = Asked(Path(*_depths(plugin)))
        result = result._replace(hidden=hidden)
    plugin.done()
    return result


def _moment(plugin: Plugin) -> Asked:
    """Return what the integrator within asks for: pictures tell their own error here, of any integrator."""
    inner = [integrator(one) for one in plugin.children(*INTEGRATORS)]
    if len(inner) != 1:
        plugin.fail(f"one integrator must be within, got {len(inner)}")
    return inner[0]


def _depths(plugin: Plugin) -> tuple[int | None, int]:
    # Mitsuba counts emission as the first bounce: a depth of 1 shows emitters only.
    depth, roulette = plugin.integer("max_depth", -1), plugin.integer("rr_depth", 5)
    if depth == 0 or depth < -1 or roulette < 1:
        plugin.fail(
            f"max_depth must be -1 or at least 1, and rr_depth at least 1, got {depth} and {roulette}"
        )
    return None if depth < 0 else depth - 1, roulette - 1


def _direct(plugin: Plugin) -> Asked:
    both = plugin.integer("shading_samples", 1)
    light, surface = (plugin.integer(f"{name}_samples", both) for name in ("emitter", "bsdf"))
    if light < 0 or surface < 0 or light + surface < 1:
        plugin.fail(
            f"emitter_samples and bsdf_samples must be at least 0, and not both, got {light} and {surface}"
        )
    # Either strategy alone finds the same light on average, except light that only the other can find.
    if surface == 0:
        plugin.warn(
            "without bsdf_samples mirrors and smooth glass would be black; here they reflect emitters"
        )
    elif light == 0:
        plugin.warn("without emitter_samples pictures are noisier in Mitsuba than here, but otherwise equal")
    return Asked(Direct(max(light, 1), max(surface, 1)), unaimed=light == 0)


def _aov(plugin: Plugin) -> Asked:
    inner = [integrator(one) for one in plugin.children(*INTEGRATORS)]
    if len(inner) > 1:
        plugin.fail("at most one integrator can be within")
    names = []
    for part in filter(None, (part.strip() for part in plugin.text("aovs").split(","))):
        kind = part.rpartition(":")[2].strip()
        if kind not in _AOVS:
            plugin.fail(f"aovs must be of {', '.join(_AOVS)}, got {kind!r}")
        names.append(_AOVS[kind])
    light = inner[0] if inner else Asked(Path(0))
    return light._replace(aov=tuple(dict.fromkeys([*names, *light.aov])))


class Sampling(NamedTuple):
    """Where the samples of a pixel come from.

    Attributes
    ----------
    sampler : Sobol or another kind, or None
        None where none is named.
    samples : int
        Of a pixel.
    seed : int
        Seed of the random numbers.
    unnamed : str, optional
        Why none is named although there is one.
    """

    sampler: Sampler | None = None
    samples: int = 4
    seed: int = 0
    unnamed: str | None = None


def sampler(plugin: Plugin | None) -> Sampling:
    """Return a sampler if one is named, how many samples a pixel it takes, and its seed.

    Independent samples are Mitsuba's default, and its exporters write them: they are not a choice.
    """
    if plugin is None:
        return Sampling()
    kinds: dict[str, Sampler | None] = {
        "independent": None,
        "ldsampler": Sobol(),
        "sobol": Sobol(),
        "halton": Halton(),
        "hammersley": Halton(),
    }
    plugin.ignore("jitter", "strength")
    count, seed = plugin.integer("sample_count", 4), plugin.integer("seed", 0)
    plugin.done()
    if count < 1 or seed < 0:
        plugin.fail(f"sample_count must be at least 1 and seed at least 0, got {count} and {seed}")
    unnamed = "the file's independent sampler is Mitsuba's default, and taken as not named"
    kind = kinds.get(plugin.type, Stratified())
    return Sampling(kind, count, seed, unnamed if kind is None else None)


def rfilter(plugin: Plugin | None, has_border: bool) -> Filter:
    """Return a reconstruction filter; Mitsuba's own, a Gaussian, if there is none.

    Unless a film has a border, what lies beyond it counts for no pixel.
    """
    whole = GaussianFilter(2.0, 0.5) if plugin is None else _filter(plugin)
    return whole if has_border or whole == BoxFilter() else CroppedFilter(whole)


def _filter(plugin: Plugin) -> WholeFilter:
    readers: dict[str, Callable[[Plugin], WholeFilter]] = {
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
