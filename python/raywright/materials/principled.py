"""The principled models of the film studios."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..arrays import integer, positive
from ..textures.texture import Number, Texture, Value, scalar, value
from .dispersion import Dispersion, one_index
from .material import Material

_SHARES = (
    "roughness", "anisotropic", "transmission", "specular_tint", "sheen", "sheen_tint", "flatness",
)  # fmt: skip


@dataclass(frozen=True, init=False)
class Principled(Material):
    """The principled model: a few parameters for plastic, metal and glass, with sheen and a clear coat.

    Burley's ("Physically Based Shading at Disney", 2012, and "Extending the Disney BRDF to a BSDF with
    Integrated Subsurface Scattering", 2015), with lobes that together conserve energy, to 0.2 %: a white
    material reflects all light from every direction, for all other parameters. It mixes metal, a matt base
    under a dielectric, and clear dielectric, with GGX facets. Multiple scattering between facets is included;
    the base gets the light that the facets above it transmit, and both get the light that the coat transmits.
    The base has the azimuthal distribution of Burley's. All parts are reciprocal.

    Opaque materials are the same on both sides. Transmissive ones are solids, whose normals point out.

    Parameters
    ----------
    base_color : float, 3 floats or Texture
        Color of diffuse reflection, of metal, and of light transmitted through two surfaces, in [0, 1].
    roughness : float or Texture
        Roughness from 0, smooth, to 1. Its square is the alpha of the facets, 0.001 at least.
    metallic : float or Texture
        Metalness from 0, none, to 1, metal.
    ior : float, Cauchy or Sellmeier
        The index of refraction of the dielectric parts, above 0. An index by wavelength, such as those of
        `glasses`, disperses transmitted light; without transmission, its value for yellow light is used.
    transmission : float or Texture
        Share of the dielectric part that is clear, in [0, 1].
    anisotropic : float or Texture
        Elongation of metal highlights along u, in [0, 1].
    specular_tint : float or Texture
        Share of the base color in highlights of the opaque dielectric, in [0, 1].
    sheen, sheen_tint : float or Texture
        Grazing reflection, as of cloth, and the share of the base color in it, in [0, 1].
    flatness : float or Texture
        Share of subsurface-like, flat diffuse reflection, in [0, 1].
    clearcoat, clearcoat_gloss : float or Texture
        Weight of a coat of index 1.5 on opaque parts, and its gloss, in [0, 1].
    priority : int
        Priority among overlapping solids, as in `Dielectric`.
    energy_conserving : bool
        True for a model without gain or loss of energy. False is the model as published, and as in Mitsuba 3:
        rough facets lose light, while the base also reflects the light that the facets reflect. White matt
        surfaces then reflect up to 15 % too much, and 45 % at 85 degrees; all highlights are stretched and
        tinted; and transmissive materials only reflect and refract if seen from within.

    Raises
    ------
    ValueError
        If a number is out of range or not finite.
    TypeError
        If an argument has another type.

    See Also
    --------
    PrincipledThin : A sheet.
    MetallicRough : glTF's model.

    Examples
    --------
    >>> car = rw.Principled((0.6, 0, 0), roughness=0.4, clearcoat=1, clearcoat_gloss=0.9)
    >>> scene = rw.Scene(rw.Sphere(material=rw.Principled(1.0, roughness=0.5)), environment=1.0)
    >>> camera = rw.Camera((0, 0, 5), (0, 0, 0), fov=10, width=4, height=4)
    >>> image = rw.render(scene, camera, samples=64, progress=False)
    >>> round(image.rgb.mean().item(), 1)
    1.0
    """

    base_color: Value
    roughness: Number
    metallic: Number
    ior: float | Dispersion
    transmission: Number
    anisotropic: Number
    specular_tint: Number
    sheen: Number
    sheen_tint: Number
    flatness: Number
    clearcoat: Number
    clearcoat_gloss: Number
    priority: int
    energy_conserving: bool

    def __init__(
        self,
        base_color: ArrayLike | Texture = 0.5,
        roughness: float | Texture = 0.5,
        metallic: float | Texture = 0.0,
        *,
        ior: float | Dispersion = 1.5,
        transmission: float | Texture = 0.0,
        anisotropic: float | Texture = 0.0,
        specular_tint: float | Texture = 0.0,
        sheen: float | Texture = 0.0,
        sheen_tint: float | Texture = 0.0,
        flatness: float | Texture = 0.0,
        clearcoat: float | Texture = 0.0,
        clearcoat_gloss: float | Texture = 0.0,
        priority: int = 0,
        energy_conserving: bool = True,
    ) -> None:
        given = locals()
        shares = (*_SHARES, "metallic", "clearcoat", "clearcoat_gloss")
        self._set(
            base_color=value("base_color", base_color, most=1.0),
            ior=ior if isinstance(ior, Dispersion) else positive("ior", ior),
            priority=integer("priority", priority, -(2**31), 2**31 - 1),
            energy_conserving=_flag(energy_conserving),
            **{name: scalar(name, given[name], most=1.0) for name in shares},
        )


@dataclass(frozen=True, init=False)
class PrincipledThin(Material):
    """The principled model of a sheet: leaves, paper, bubbles.

    Burley's ("Extending the Disney BRDF to a BSDF with Integrated Subsurface Scattering", 2015), as in
    Mitsuba 3. Both sides are alike, and nothing is enclosed: light is transmitted straight, spread, or
    scattered.

    Parameters
    ----------
    base_color : float, 3 floats or Texture
        Color of diffuse reflection and of transmission, in [0, 1].
    roughness : float or Texture
        Roughness from 0, smooth, to 1. Its square is the alpha of the facets, 0.001 at least.
    ior : float
        The index of refraction, above 0.
    transmission : float or Texture
        Share of clear transmission, in [0, 1]; the rest is matt.
    diffuse_transmission : float or Texture
        Share of the diffuse light that is scattered to the other side, in [0, 1].
    anisotropic, specular_tint, sheen, sheen_tint, flatness : float or Texture
        As in `Principled`; highlights are not stretched, but of the published model.
    energy_conserving : bool
        As in `Principled`. The published model also lets light through by a roughness of its own, which goes
        with the index; otherwise `roughness` serves for both.

    Raises
    ------
    ValueError
        If a number is out of range or not finite.
    TypeError
        If an argument has another type.

    See Also
    --------
    Principled : A solid.
    ThinDielectric : A clear pane.

    Examples
    --------
    >>> leaf = rw.materials.PrincipledThin((0.1, 0.5, 0.1), diffuse_transmission=0.5)
    >>> leaf.diffuse_transmission
    0.5
    """

    base_color: Value
    roughness: Number
    ior: float
    transmission: Number
    diffuse_transmission: Number
    anisotropic: Number
    specular_tint: Number
    sheen: Number
    sheen_tint: Number
    flatness: Number
    energy_conserving: bool

    def __init__(
        self,
        base_color: ArrayLike | Texture = 0.5,
        roughness: float | Texture = 0.5,
        *,
        ior: float = 1.5,
        transmission: float | Texture = 0.0,
        diffuse_transmission: float | Texture = 0.0,
        anisotropic: float | Texture = 0.0,
        specular_tint: float | Texture = 0.0,
        sheen: float | Texture = 0.0,
        sheen_tint: float | Texture = 0.0,
        flatness: float | Texture = 0.0,
        energy_conserving: bool = True,
    ) -> None:
        given = locals()
        self._set(
            base_color=value("base_color", base_color, most=1.0),
            ior=one_index(ior, "a sheet sends all colors straight on"),
            energy_conserving=_flag(energy_conserving),
            **{name: scalar(name, given[name], most=1.0) for name in (*_SHARES, "diffuse_transmission")},
        )


def _flag(given: bool) -> bool:
    if not isinstance(given, bool):
        raise TypeError(f"energy_conserving must be True or False, got {given!r}")
    return given
