"""The principled models of the film studios."""

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
    """The principled model: many looks by a few numbers, from plastic to metal to glass, under a clear coat.

    Burley's ("Physically Based Shading at Disney", 2012, and "Extending the Disney BRDF to a BSDF with
    Integrated Subsurface Scattering", 2015), with lobes that together give back what comes, to 0.2 %: white
    is white from every direction, whatever the other numbers are. It is a mixture of metal, of a matt base
    under a dielectric, and of clear dielectric, of GGX's facets. What facets throw on facets goes on, the
    base gets what the facets above it leave, and both get what the coat leaves. The base spreads its light
    over azimuths as Burley's does. All parts are reciprocal.

    What lets no light through is the same on both sides. What does is a solid, whose normals point out.

    Parameters
    ----------
    base_color : float, 3 floats or Texture
        Colour of what is matt, of what metal reflects, and of what has gone through two surfaces, in [0, 1].
    roughness : float or Texture
        From 0, smooth, to 1. Its square is the alpha of the facets, 0.001 at least.
    metallic : float or Texture
        From 0, none, to 1, metal.
    ior : float, Cauchy or Sellmeier
        The index of refraction of what is no metal, above 0. One that goes with wavelength, as those of
        `glasses`, spreads what goes through into its colours; where nothing does, it is that of yellow
        light.
    transmission : float or Texture
        The share of what is no metal that is clear, in [0, 1].
    anisotropic : float or Texture
        How much longer highlights of metal are along u than along v, in [0, 1].
    specular_tint : float or Texture
        How much of the colour highlights of what is neither metal nor clear have, in [0, 1].
    sheen, sheen_tint : float or Texture
        Light along the edges, as of cloth, and how much of the colour it has, in [0, 1].
    flatness : float or Texture
        How much of what is matt is as flat as if light got deep into it, in [0, 1].
    clearcoat, clearcoat_gloss : float or Texture
        How much of a coat of index 1.5 there is on what is not clear, and how glossy it is, in [0, 1].
    priority : int
        Where solids overlap, as `Dielectric` has it.
    energy_conserving : bool
        Whether no light is gained or lost. If not, it is the model as it was published, and as Mitsuba 3 has
        it: rough facets lose light, as nothing takes from the base what the facets above reflect white and
        matt surfaces give up to 15 % more than they get, and at 85 degrees 45 %, all highlights are stretched
        and tinted, and what lets light through reflects and refracts only, seen from within.

    Raises
    ------
    ValueError
        If a number is out of range or not finite.
    TypeError
        If something is not of the kinds above.
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
        roughness: "float | Texture" = 0.5,
        metallic: "float | Texture" = 0.0,
        *,
        ior: float | Dispersion = 1.5,
        transmission: "float | Texture" = 0.0,
        anisotropic: "float | Texture" = 0.0,
        specular_tint: "float | Texture" = 0.0,
        sheen: "float | Texture" = 0.0,
        sheen_tint: "float | Texture" = 0.0,
        flatness: "float | Texture" = 0.0,
        clearcoat: "float | Texture" = 0.0,
        clearcoat_gloss: "float | Texture" = 0.0,
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

    Burley's ("Extending the Disney BRDF to a BSDF with Integrated Subsurface Scattering", 2015), as Mitsuba 3
    has it. Both sides are alike, and nothing is enclosed: light goes on as it came, spread, or is scattered.

    Parameters
    ----------
    base_color : float, 3 floats or Texture
        Colour of what is matt and of what goes through, in [0, 1].
    roughness : float or Texture
        From 0, smooth, to 1. Its square is the alpha of the facets, 0.001 at least.
    ior : float
        The index of refraction, above 0.
    transmission : float or Texture
        The share that is clear, in [0, 1]; the rest is matt.
    diffuse_transmission : float or Texture
        The share of what is matt that is scattered on the other side, in [0, 1].
    anisotropic, specular_tint, sheen, sheen_tint, flatness : float or Texture
        As `Principled` has them; highlights are not stretched, but of the published model.
    energy_conserving : bool
        As `Principled` has it. The published model also lets light through by a roughness of its own,
        which goes with the index; otherwise `roughness` serves for both.

    Raises
    ------
    ValueError
        If a number is out of range or not finite.
    TypeError
        If something is not of the kinds above.
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
        roughness: "float | Texture" = 0.5,
        *,
        ior: float = 1.5,
        transmission: "float | Texture" = 0.0,
        diffuse_transmission: "float | Texture" = 0.0,
        anisotropic: "float | Texture" = 0.0,
        specular_tint: "float | Texture" = 0.0,
        sheen: "float | Texture" = 0.0,
        sheen_tint: "float | Texture" = 0.0,
        flatness: "float | Texture" = 0.0,
        energy_conserving: bool = True,
    ) -> None:
        given = locals()
        self._set(
            base_color=value("base_color", base_color, most=1.0),
            ior=one_index(ior, "a sheet sends all colours straight on"),
            energy_conserving=_flag(energy_conserving),
            **{name: scalar(name, given[name], most=1.0) for name in (*_SHARES, "diffuse_transmission")},
        )


def _flag(given: bool) -> bool:
    if not isinstance(given, bool):
        raise TypeError(f"energy_conserving must be True or False, got {given!r}")
    return given
