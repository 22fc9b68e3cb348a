"""Films of the colours of their thickness."""

from dataclasses import dataclass

from ..textures.texture import Number, Texture, scalar
from .conductor import Conductor
from .dielectric import Dielectric
from .dispersion import one_index
from .material import Material


@dataclass(frozen=True, init=False)
class ThinFilm(Material):
    """A film on glass, water or metal, of the colours of its thickness: oil on water, a lens's coat, oxide.

    What both faces of the film reflect interferes: Airy's sum over all reflections within it, of both
    polarisations, integrated over the wavelengths of daylight (CIE D65) as the standard observer sees them
    (CIE 1931), in linear Rec. 709, at each angle. Light comes to it unpolarised. What does not go back goes
    through, or into the metal: a film absorbs nothing. Where it has no thickness, what it lies on is bare.

    A colour may be too pure for red, green and blue to mix: each channel of what is reflected is then cut off
    at 0, and of what is clear at 1, by some thousandths of the light (0.005 of a soap film), so that no light
    is negative, and what is reflected and what goes through are together all that came. Of named metals a
    channel may exceed 1, as `Conductor` says.

    The indices of the film and of what is clear are the same at all wavelengths, those of a named metal as
    they were measured, and `eta` and `k` of others the same for all wavelengths of their channel. Of what is
    clear, and of metals by `eta` and `k`, the share reflected is that of the integral to within 2e-5; of
    named metals, by tables over angle, to 5e-5, and where their film's thickness varies, by tables over that
    too, to 3e-4 up to 66 degrees and to 5e-3 near grazing incidence. Of films thicker than some 6 µm hardly
    any fringes are seen: of light that is more than 48 µm behind, they are left out.

    On a rough base each facet has the film. What facets throw on each other goes by the bare base, and of a
    clear one so does that part of a facet from which other facets stop light, be it reflected or refracted:
    so a rough one keeps all light that a bare one does.

    Parameters
    ----------
    thickness : float or Texture
        How thick it is, in nanometres, not negative. Of a texture with colours, the mean of the channels.
    ior : float
        The index of refraction within the film, above 0: 1.33 for water, 1.38 for magnesium fluoride, 1.47
        for oil, 2.5 for the oxide of titanium.
    base : Dielectric or Conductor
        What it lies on. What that encloses, how rough it is and its priority stay as they are.

    Raises
    ------
    ValueError
        If `thickness` is negative or not finite, or `ior` is not greater than 0.
    TypeError
        If something is not of the kinds above.
    """

    thickness: Number
    ior: float
    base: Dielectric | Conductor

    def __init__(
        self,
        thickness: "float | Texture",
        ior: float = 1.33,
        *,
        base: Dielectric | Conductor,
    ) -> None:
        if not isinstance(base, (Dielectric, Conductor)):
            raise TypeError(f"base must be a Dielectric or a Conductor, got {type(base).__name__}")
        self._set(
            thickness=scalar("thickness", thickness),
            ior=one_index(ior, "films have the same for all colours"),
            base=base,
        )


@dataclass(frozen=True, init=False)
class SoapFilm(Material):
    """The skin of a soap bubble: a film with the same around it on both sides, of its thickness's colours.

    Light goes through it straight, as through a `ThinDielectric`, and it encloses nothing. Its colours are
    those of a `ThinFilm`: black where it is much thinner than a wave, then white, yellow, magenta, blue and
    green in turn, paler the thicker it is. What is so thick that no colours are left is a `ThinDielectric`.

    Parameters
    ----------
    thickness : float or Texture
        How thick it is, in nanometres, not negative. Of a texture with colours, the mean of the channels.
    ior : float
        The index of refraction within the film, above 0.

    Raises
    ------
    ValueError
        If `thickness` is negative or not finite, or `ior` is not greater than 0.
    TypeError
        If something is not of the kinds above.
    """

    thickness: Number
    ior: float

    def __init__(
        self,
        thickness: "float | Texture",
        ior: float = 1.33,
    ) -> None:
        self._set(
            thickness=scalar("thickness", thickness),
            ior=one_index(ior, "films have the same for all colours"),
        )
