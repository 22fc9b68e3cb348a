"""A homogeneous medium: the same everywhere."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..arrays import Triple
from ..textures.spectrum import Spectrum, color_or_spectrum
from .medium import Medium
from .phases import Isotropic, Phase, phase


@dataclass(frozen=True, init=False)
class Homogeneous(Medium):
    """A homogeneous medium: the same everywhere.

    Its transmittance is exp(-(absorption + scattering) · length) (Beer and Lambert). Lengths are in world
    units, also in instances.

    Parameters
    ----------
    absorption, scattering : float, 3 floats or Spectrum
        The share of light that is absorbed, and scattered, per unit of length: one number, or red, green and
        blue, at least 0.
    phase : HenyeyGreenstein, Rayleigh or Isotropic
        Phase function.
    emission : float, 3 floats or Spectrum
        Emitted radiance per unit of length, at least 0. A deep medium has the radiance emission / absorption.

    Raises
    ------
    ValueError
        If a number is negative or not finite, or there are neither 1 nor 3 of them.
    TypeError
        If an argument has another type.

    See Also
    --------
    GridMedium : A density on a grid.
    MediumInterface : A shape around a medium.

    Examples
    --------
    >>> haze = rw.Homogeneous(absorption=0.1, scattering=0.1)
    >>> scene = rw.Scene(rw.Sphere((0, 0, -9)), medium=haze)
    >>> scene.transmittance([0, 0, 0], [0, 0, -1], t_max=5).round(4).tolist()
    [0.3679, 0.3679, 0.3679]
    """

    absorption: Triple | Spectrum
    scattering: Triple | Spectrum
    phase: Phase
    emission: Triple | Spectrum

    def __init__(
        self,
        absorption: ArrayLike | Spectrum = 0.0,
        scattering: ArrayLike | Spectrum = 0.0,
        phase: Phase = Isotropic(),  # noqa: B008
        emission: ArrayLike | Spectrum = 0.0,
    ) -> None:
        _set(self, absorption=absorption, scattering=scattering, emission=emission)
        object.__setattr__(self, "phase", _phase("phase", phase))


_phase = phase


def _set(medium: Medium, **values: ArrayLike | Spectrum) -> None:
    for name, value in values.items():
        object.__setattr__(medium, name, color_or_spectrum(name, value))
