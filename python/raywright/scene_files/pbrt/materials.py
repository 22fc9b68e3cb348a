"""Materials."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from ...materials import (
    BumpMap,
    Conductor,
    Dielectric,
    Diffuse,
    Mask,
    Material,
    Mix,
    NormalMap,
    Plastic,
    PrincipledThin,
    ThinDielectric,
)
from ...materials.dispersion import Dispersion
from ...materials.glasses import glasses
from ...textures import ImageTexture
from ...textures.texture import Number, Texture
from ..notes import Notes
from .parameters import Parameters
from .spectra import GLASS, color
from .textures import Textures, bounded

REFUSED = ("hair", "measured", "subsurface")


class Materials:
    """The materials of a scene by name, and how they are read.

    Parameters
    ----------
    textures : Textures
        Those of the scene.
    notes : Notes
        Notes about the scene.
    """

    def __init__(self, textures: Textures, notes: Notes) -> None:
        self._textures, self._notes = textures, notes
        self._named: dict[str, Material] = {}

    def add(self, name: str, parameters: Parameters) -> None:
        """Keep a material."""
        self._named[name] = self.material(parameters.text("type"), parameters)

    def has(self, name: str) -> bool:
        """Return whether there is a material of that name so far."""
        return name in self._named

    def named(self, name: str, parameters: Parameters) -> Material:
        """Return one that was kept."""
        if name not in self._named:
            parameters.fail(f"there is no material {name!r}")
        return self._named[name]

    def material(self, kind: str, parameters: Parameters) -> Material:
        """Return a material of a type.

        Raises
        ------
        ValueError
            If its type, or a parameter of it, is not supported; the error names it.
        """
        readers: dict[str, Callable[[Parameters], Material]] = {
            "diffuse": self._diffuse,
            "coateddiffuse": self._coated_diffuse,
            "coatedconductor": self._coated_conductor,
            "conductor": self._conductor,
            "dielectric": self._dielectric,
            "thindielectric": self._thin_dielectric,
            "diffusetransmission": self._transmission,
            "mix": self._mix,
            "interface": lambda _: Mask(Diffuse(0.0), 0.0),
            "": lambda _: Mask(Diffuse(0.0), 0.0),
            "none": lambda _: Mask(Diffuse(0.0), 0.0),
        }
        if kind not in readers:
            parameters.fail(f"a material {kind!r} is not supported")
        try:
            made = readers[kind](parameters)
            made = self._raised(made, parameters)
        except (ValueError, TypeError) as error:
            if str(error).startswith(parameters.where):
                raise
            parameters.fail(str(error))
        parameters.done()
        return made

    def _raised(self, made: Material, parameters: Parameters) -> Material:
        if parameters.has("displacement"):
            made = BumpMap(made, self._textures.number(parameters, "displacement", 0.0))
        if parameters.has("normalmap"):
            path = self._textures.folder / parameters.text("normalmap")
            made = NormalMap(made, ImageTexture(path, linear=True))
        return made

    def _color(self, parameters: Parameters, name: str, default: float) -> Any:
        return bounded(self._textures.value(parameters, name, default), name)

    def _diffuse(self, parameters: Parameters) -> Material:
        return Diffuse(self._color(parameters, "reflectance", 0.5))

    def _alpha(self, parameters: Parameters, prefix: str = "", default: float = 0.0) -> tuple[Number, Number]:
        both = self._textures.number(parameters, f"{prefix}roughness", default)
        pair = [
            self._textures.number(parameters, f"{prefix}{axis}roughness", 0.0)
            if parameters.has(f"{prefix}{axis}roughness")
            else both
            for axis in "uv"
        ]
        if not parameters.switch("remaproughness", True):
            return pair[0], pair[1]
        if any(isinstance(one, Texture) for one in pair):
            parameters.fail("a roughness by texture must have remaproughness false")
        if min(float(one) for one in pair) < 0:  # type: ignore[arg-type]
            parameters.fail("a roughness must be at least 0")
        # pbrt's mapping from roughness to alpha, a square root.
        u, v = (math.sqrt(min(float(one), 1.0)) for one in pair)  # type: ignore[arg-type]
        return u, v

    def _ior(self, parameters: Parameters, name: str, default: float) -> float:
        """Return an index of refraction for all light: that of yellow light."""
        found = self._index(parameters, name, default)
        return found.index() if isinstance(found, Dispersion) else found

    def _index(self, parameters: Parameters, name: str, default: float) -> float | Dispersion:
        found = parameters.given.get(name)
        if found is not None and found[0] == "spectrum" and len(found[1]) == 1:
            key = parameters.text(name)
            if key not in GLASS:
                parameters.fail(f"{name} must be a number or one of {', '.join(GLASS)}, got {key!r}")
            return glasses[GLASS[key]]
        if found is not None and found[0] == "spectrum":
            table = parameters.numbers(name, 2)
            assert table is not None
            if not len(table) or (np.diff(table[:, 0]) <= 0).any():
                parameters.fail(f"{name} must have increasing wavelengths, each with an index")
            # The index at the Fraunhofer d line, since the table has no formula.
            return float(np.interp(587.6, table[:, 0], table[:, 1]))
        return parameters.number(name, default)

    def _coated_diffuse(self, parameters: Parameters) -> Material:
        self._notes.tell("coateddiffuse is approximated by a plastic without thickness")
        parameters.ignore("thickness", "maxdepth", "nsamples", "g")
        parameters.leave_out("albedo")
        u, v = self._alpha(parameters)
        if isinstance(u, Texture) or isinstance(v, Texture):
            parameters.fail("the roughness of a coat must be a number")
        return Plastic(
            self._color(parameters, "reflectance", 0.5),
            self._ior(parameters, "eta", 1.5),
            alpha=math.sqrt(u * v),
        )

    def _coated_conductor(self, parameters: Parameters) -> Material:
        self._notes.tell("coatedconductor is approximated by its metal without the coat")
        parameters.ignore(
            "thickness", "maxdepth", "nsamples", "g", "albedo", "interface.roughness", "interface.eta"
        )
        parameters.ignore("interface.uroughness", "interface.vroughness")
        return self._metal(parameters, "conductor.")

    def _conductor(self, parameters: Parameters) -> Material:
        return self._metal(parameters, "")

    def _metal(self, parameters: Parameters, prefix: str) -> Material:
        alpha = self._alpha(parameters, prefix)
        rough: dict[str, Any] = {"alpha": alpha, "multiple_scattering": False}
        reflectance = f"{prefix}reflectance" if parameters.has(f"{prefix}reflectance") else "reflectance"
        if parameters.has(reflectance):
            share = np.minimum(color(parameters, reflectance, 0.5), 0.9999)
            if share.min() < 0:
                parameters.fail(f"{reflectance} must be at least 0, got {share.min():g}")
            return Conductor(eta=1.0, k=2 * np.sqrt(share) / np.sqrt(1 - share), **rough)
        names = [
            one[1][0]
            if one is not None and one[0] == "spectrum" and one[1] and isinstance(one[1][0], str)
            else None
            for one in (parameters.given.get(f"{prefix}{name}") for name in ("eta", "k"))
        ]
        if names[0] is not None or not parameters.has(f"{prefix}eta"):
            metals = [
                name and name.removesuffix(end) for name, end in zip(names, ("-eta", "-k"), strict=True)
            ]
            if parameters.has(f"{prefix}k") and (metals[0] is None or metals[0] != metals[1]):
                parameters.fail("eta and k must both be of one metal, or both be numbers")
            parameters.ignore(f"{prefix}eta", f"{prefix}k")
            metal = str(names[0] or "metal-Cu-eta").removeprefix("metal-").removesuffix("-eta")
            return Conductor(metal, **rough)
        eta = np.maximum(color(parameters, f"{prefix}eta", 1.0), 1e-9)
        return Conductor(eta=eta, k=color(parameters, f"{prefix}k", 1.0), **rough)

    def _dielectric(self, parameters: Parameters) -> Material:
        u, v = self._alpha(parameters)
        if u != v:
            parameters.fail("uroughness and vroughness must be the same")
        return Dielectric(self._index(parameters, "eta", 1.5), alpha=u, multiple_scattering=False)

    def _thin_dielectric(self, parameters: Parameters) -> Material:
        return ThinDielectric(self._ior(parameters, "eta", 1.5))

    def _transmission(self, parameters: Parameters) -> Material:
        self._notes.tell("diffusetransmission is approximated by the principled sheet")
        shares = [np.array(color(parameters, name, 0.25)) for name in ("reflectance", "transmittance")]
        scale = parameters.number("scale", 1.0)
        total = np.minimum(scale * (shares[0] + shares[1]), 1.0)
        through = float(shares[1].sum() / max(shares[0].sum() + shares[1].sum(), 1e-300))
        return PrincipledThin(total, 0.0, diffuse_transmission=through)

    def _mix(self, parameters: Parameters) -> Material:
        found = parameters.take("materials")
        if found is None or len(found[1]) != 2:
            parameters.fail("materials must be 2 names")
        a, b = (self.named(str(name), parameters) for name in found[1])
        return Mix(a, b, self._textures.number(parameters, "amount", 0.5))
