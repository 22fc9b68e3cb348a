"""What conductors and dielectrics have in common: roughness, and shares of what they reflect."""

from ...materials import Conductor, Dielectric, Diffuse, Material, Mirror, Mix
from ...materials.material import Rough
from ...textures.texture import Texture
from .iors import relative
from .plugin import Plugin
from .textures import scalar, value
from .uv import Uv

# Stands for an index of refraction of 0, at which everything is reflected.
_NEXT_TO_NOTHING = 1e-9


def conductor(plugin: Plugin, uv: Uv) -> Material:
    """Return the material of a ``conductor`` or ``roughconductor``."""
    rough = roughness(plugin, uv) if plugin.type == "roughconductor" else 0.0
    name = plugin.text("material", "none")
    if plugin.has("eta") or plugin.has("k"):
        if name != "none":
            plugin.fail("either material or eta and k must be given, got both")
        eta, k = value(plugin, "eta", 0.0, uv), value(plugin, "k", 1.0, uv)
        if not isinstance(eta, Texture):
            eta = tuple(max(x, _NEXT_TO_NOTHING) for x in eta)  # type: ignore[assignment]
        metal: Material = Conductor(eta=eta, k=k, alpha=rough)
    elif name != "none":
        # Of some it also has, or only has, the values of Palik's handbook.
        metal = Conductor(name.removesuffix("_palik"), alpha=rough)
    elif plugin.type == "conductor":
        return Mirror(value(plugin, "specular_reflectance", 1.0, uv))
    else:
        metal = Conductor(eta=_NEXT_TO_NOTHING, k=1.0, alpha=rough)
    return scaled(metal, plugin, ("specular_reflectance",), uv)


def dielectric(plugin: Plugin, uv: Uv) -> Material:
    """Return the material of a ``dielectric`` or ``roughdielectric``."""
    rough = roughness(plugin, uv) if plugin.type == "roughdielectric" else 0.0
    if isinstance(rough, tuple):
        plugin.fail("alpha_u and alpha_v are not supported")
    solid = Dielectric(relative(plugin, "bk7"), alpha=rough)
    return scaled(solid, plugin, ("specular_reflectance", "specular_transmittance"), uv)


def roughness(plugin: Plugin, uv: Uv) -> Rough:
    """Return the alpha of a rough BSDF, or two of them, along raywright's u and v."""
    if plugin.choice("distribution", "beckmann", ("beckmann", "ggx")) == "beckmann":
        plugin.warn("Beckmann's distribution is approximated by GGX of the same alpha")
    plugin.ignore("sample_visible")
    if not plugin.has("alpha_u") and not plugin.has("alpha_v"):
        return scalar(plugin, "alpha", 0.1, uv)
    u, v = (scalar(plugin, name, 0.1, uv) for name in ("alpha_u", "alpha_v"))
    return (v, u) if uv.turned else (u, v)


def scaled(given: Material, plugin: Plugin, names: tuple[str, ...], uv: Uv) -> Material:
    """Return a material of which only a share is left, the same for each of some parameters and grey."""
    shares = [value(plugin, name, 1.0, uv) for name in names]
    if any(isinstance(share, Texture) or len({*share}) != 1 for share in shares) or len({*shares}) != 1:
        plugin.fail(f"{' and '.join(names)} must be one number{', the same' if len(names) > 1 else ''}")
    share = shares[0]
    assert not isinstance(share, Texture)
    return given if share[0] == 1.0 else Mix(given, Diffuse(0.0), 1.0 - share[0])
