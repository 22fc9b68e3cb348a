"""Metals."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _core
from ..textures.texture import Texture, Value, value
from .material import Material, Rough, facets, rough


@dataclass(frozen=True, init=False)
class Conductor(Material):
    """A metal, smooth or rough, which may be brushed: rougher along one direction than across.

    Multiple scattering between facets is included (Kulla and Conty 2017). Both sides reflect.

    A named metal has the color of its spectrum: at each angle, Fresnel's reflectance by the measured index of
    refraction, integrated over the wavelengths of daylight (CIE D65) as the standard observer sees them (CIE
    1931), in linear Rec. 709. So a light of (1, 1, 1) has the same reflection as in a spectral renderer with
    daylight as white. A channel's reflectance may exceed 1: gold is (1.022, 0.782, 0.344), an orange outside
    the gamut of red, green and blue. In repeated reflections by gold, each one after the first reflects at
    most 96.2 % of the red, the maximum over all wavelengths. So two to five reflections are correct to 3 %,
    and energy stays bounded. An integrator in Python gets the value of the first reflection each time.

    Parameters
    ----------
    metal : str, optional
        Name or symbol, such as ``"gold"`` or ``"Au"``; `metals` lists all names, `metal_index` has the
        measured index of each.
    eta, k : float, 3 floats or Texture, optional
        Real and imaginary part of its index of refraction, in place of a name: `eta` above 0, `k` at least 0.
        Three numbers are for red, green and blue.
    roughness : float, Texture, or a pair of them, optional
        Roughness from 0, smooth, to 1; a pair is along u and along v. Its square is the alpha of its facets'
        distribution, as in glTF. 0 if not given.
    alpha : float, Texture, or a pair of them, optional
        Alpha, in place of `roughness`.
    distribution : {"ggx", "beckmann"}
        Distribution of facet slopes: "ggx" with long tails (Walter et al., "Microfacet Models for Refraction
        through Rough Surfaces", 2007), or "beckmann", a normal distribution (Beckmann and Spizzichino 1963),
        whose highlights have no glow around them.
    multiple_scattering : bool
        True to include multiple scattering between facets. False omits that light, so rougher surfaces are
        darker, and treats masking and shadowing as independent: the model of Walter et al., which many
        renderers use.

    Attributes
    ----------
    metal : str or None
        Its name, or None.
    eta, k : tuple of 3 floats, or Texture, or None
        The index of refraction, unless it is that of a name.

    Raises
    ------
    ValueError
        If the name is not known, there is neither a name nor both `eta` and `k`, a number is out of range, or
        there is no such distribution.
    TypeError
        If an argument has another type.

    See Also
    --------
    Mirror : The same reflectance at every angle.
    metals : The names.

    Examples
    --------
    >>> gold = rw.Conductor("gold", roughness=0.3)
    >>> gold.metal
    'gold'
    >>> aluminium_by_number = rw.Conductor(eta=1.1, k=6.8)
    >>> aluminium_by_number.eta
    (1.1, 1.1, 1.1)
    """

    metal: str | None
    eta: Value | None
    k: Value | None
    roughness: Rough | None
    alpha: Rough | None
    distribution: str
    multiple_scattering: bool

    def __init__(
        self,
        metal: str | None = None,
        *,
        eta: ArrayLike | Texture | None = None,
        k: ArrayLike | Texture | None = None,
        roughness: Any = None,
        alpha: Any = None,
        distribution: str = "ggx",
        multiple_scattering: bool = True,
    ) -> None:
        if metal is not None:
            if eta is not None or k is not None:
                raise ValueError("only one of metal and (eta, k) can be given")
            if not isinstance(metal, str):
                raise TypeError(f"metal must be a name, got {type(metal).__name__}")
            self._set(metal=_known(metal), eta=None, k=None)
        elif eta is None or k is None:
            raise ValueError("metal must be given, or both eta and k")
        else:
            self._set(metal=None, eta=value("eta", eta, above=True), k=value("k", k))
        self._set(**rough(roughness, alpha), **facets(distribution, multiple_scattering))


class MetalIndex(NamedTuple):
    """A metal's measured index of refraction, eta + ik: see `metal_index`.

    Attributes
    ----------
    wavelengths : (N,) array
        Wavelengths in nm, rising, from below 360 to beyond 830.
    eta, k : (N,) array
        The real and the imaginary part there.

    See Also
    --------
    metal_index : Makes it.

    Examples
    --------
    >>> gold = rw.materials.metal_index("gold")
    >>> bool(gold.wavelengths[0] < 360), bool((gold.k > 0).all())
    (True, True)
    """

    wavelengths: NDArray[np.float64]
    eta: NDArray[np.float64]
    k: NDArray[np.float64]


def metals() -> tuple[str, ...]:
    """Return the names of the metals that `Conductor` knows.

    Returns
    -------
    tuple of str

    See Also
    --------
    metal_index : The measured index of each.

    Examples
    --------
    >>> "gold" in rw.materials.metals(), "Au" in rw.materials.metals()
    (True, False)
    """
    return tuple(name for _, name in _core.metals())


def metal_index(metal: str) -> MetalIndex:
    """Return the measured index of refraction of a metal, by wavelength.

    `Conductor` interpolates it linearly. The sources are the "Handbook of Optical Constants of Solids" (Palik
    1985 and 1991) and papers listed by refractiveindex.info; ``rust/optics/src/conductors/measured.rs`` names
    the source of each metal.

    Parameters
    ----------
    metal : str
        Name or symbol, such as ``"gold"`` or ``"Au"``.

    Returns
    -------
    MetalIndex

    Raises
    ------
    ValueError
        If the name is not known.
    TypeError
        If it is not a name.

    See Also
    --------
    metals : The names.

    Examples
    --------
    >>> silver = rw.materials.metal_index("Ag")
    >>> n = np.interp(550, silver.wavelengths, silver.eta + 1j * silver.k)
    >>> bool(abs((n - 1) / (n + 1)) ** 2 > 0.95)
    True
    """
    if not isinstance(metal, str):
        raise TypeError(f"metal must be a name, got {type(metal).__name__}")
    return MetalIndex(*np.array(_core.metal_index(_known(metal))).T.copy())


def _known(metal: str) -> str:
    wanted = metal.casefold()
    for symbol, name in _core.metals():
        if wanted in (symbol.casefold(), name):
            return name
    raise ValueError(f"metal must be one of {', '.join(metals())}, got {metal!r}")
