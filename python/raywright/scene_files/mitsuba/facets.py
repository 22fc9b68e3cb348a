"""Facets and factors shared by conductors and dielectrics."""

from __future__ import annotations

from typing import NamedTuple, TypedDict

from ...materials import (
    Conductor,
    Dielectric,
    Diffuse,
    Material,
    Mirror,
    Mix,
    ThinDielectric,
    Tinted,
    metal_index,
)
from ...materials.material import Rough
from ...textures import Spectrum
from ...textures.texture import Texture
from .iors import relative
from .plugin import Plugin, Triple
from .textures import scalar, value
from .uv import Uv

# Replaces an index of refraction of 0, where everything is reflected.
_NEXT_TO_NOTHING = 1e-9


def conductor(plugin: Plugin, uv: Uv) -> Material:
    """Return the material of a ``conductor`` or ``roughconductor``."""
    rough = (facets(plugin, uv) if plugin.type == "roughconductor" else SMOOTH).arguments()
    name = plugin.text("material", "none")
    if plugin.has("eta") or plugin.has("k"):
        if name != "none":
            plugin.fail("either material or eta and k must be given, got both")
        eta, k = value(plugin, "eta", 0.0, uv), value(plugin, "k", 1.0, uv)
        if not isinstance(eta, Texture):
            eta = _positive(eta)
        metal: Material = Conductor(eta=eta, k=k, **rough)
    elif name != "none":
        # Some metals have Palik's values as an alternative, or only those.
        name = name.removesuffix("_palik")
        if plugin.context.by_wavelength:
            metal = Conductor(name, **rough)
        else:
            # RGB variants of Mitsuba convert eta and k to colors before computing reflection.
            index = metal_index(name)
            eta, k = (Spectrum(index.wavelengths, part).rgb for part in (index.eta, index.k))
            metal = Conductor(eta=_positive(eta), k=_positive(k), **rough)
    elif plugin.type == "conductor":
        return Mirror(value(plugin, "specular_reflectance", 1.0, uv))
    else:
        metal = Conductor(eta=_NEXT_TO_NOTHING, k=1.0, **rough)
    return scaled(metal, plugin, ("specular_reflectance",), uv)


def _positive(eta: Triple) -> Triple:
    red, green, blue = (max(x, _NEXT_TO_NOTHING) for x in eta)
    return red, green, blue


def dielectric(plugin: Plugin, uv: Uv) -> Material:
    """Return the material of a ``dielectric`` or ``roughdielectric``."""
    rough = facets(plugin, uv) if plugin.type == "roughdielectric" else SMOOTH
    if isinstance(rough.alpha, tuple):
        plugin.fail("alpha_u and alpha_v are not supported")
    return tinted(Dielectric(relative(plugin, "bk7"), **rough.arguments()), plugin, uv)


def tinted(clear: Dielectric | ThinDielectric, plugin: Plugin, uv: Uv) -> Material:
    """Return a clear material with the tints of its reflection and transmission."""
    reflected, through = (
        value(plugin, f"specular_{name}", 1.0, uv) for name in ("reflectance", "transmittance")
    )
    whole = (1.0, 1.0, 1.0)
    return clear if (reflected, through) == (whole, whole) else Tinted(clear, through, reflected)


class Arguments(TypedDict):
    """Arguments of rough materials about their facets."""

    alpha: Rough
    distribution: str
    multiple_scattering: bool


class Facets(NamedTuple):
    """Roughness of a surface: the alpha, or two of them along raywright's u and v."""

    alpha: Rough
    distribution: str = "ggx"
    multiple_scattering: bool = True

    def arguments(self) -> Arguments:
        """Return them as raywright's materials take them."""
        return Arguments(
            alpha=self.alpha,
            distribution=self.distribution,
            multiple_scattering=self.multiple_scattering,
        )


SMOOTH = Facets(0.0)


def facets(plugin: Plugin, uv: Uv) -> Facets:
    """Return the facets of a rough BSDF, which scatter once in Mitsuba.

    Only the noise depends on ``sample_visible``.
    """
    distribution = plugin.choice("distribution", "beckmann", ("beckmann", "ggx"))
    plugin.ignore("sample_visible")
    if not plugin.has("alpha_u") and not plugin.has("alpha_v"):
        return Facets(scalar(plugin, "alpha", 0.1, uv), distribution, False)
    if plugin.has("alpha"):
        plugin.fail("either alpha or alpha_u and alpha_v must be given, got both")
    u, v = (scalar(plugin, name, 0.1, uv) for name in ("alpha_u", "alpha_v"))
    return Facets((v, u) if uv.turned else (u, v), distribution, False)


def scaled(given: Material, plugin: Plugin, names: tuple[str, ...], uv: Uv) -> Material:
    """Return a material scaled by a factor, the same for each of some parameters and gray."""
    shares = [value(plugin, name, 1.0, uv) for name in names]
    if any(isinstance(share, Texture) or len({*share}) != 1 for share in shares) or len({*shares}) != 1:
        plugin.fail(f"{' and '.join(names)} must be one number{', the same' if len(names) > 1 else ''}")
    share = shares[0]
    assert not isinstance(share, Texture)
    return given if share[0] == 1.0 else Mix(given, Diffuse(0.0), 1.0 - share[0])
