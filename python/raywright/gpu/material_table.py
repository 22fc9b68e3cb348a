"""Materials as rows of an array, with their tables and pictures."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..materials import Conductor, Dielectric, Diffuse, Material, Mirror, Plastic, TwoSided
from ..textures.image import ImageTexture
from .facets import ENTRIES, coat_table, loss_table, mean_fresnel, mean_of
from .measured import made_up, reflectances

# 80 bytes: see `Material` of shading.wgsl.
MATERIAL = np.dtype(
    [
        ("color", "<f4", 3),
        ("kind", "<u4"),
        ("eta", "<f4", 3),
        ("alpha", "<f4"),
        ("k", "<f4", 3),
        ("table", "<u4"),
        ("multiple", "<f4", 3),
        ("losses", "<u4"),
        ("picture", "<u4"),
        ("reserved", "<u4", 3),
    ]
)
_NO = 0xFFFFFFFF
_DIFFUSE, _MIRROR, _GLASS, _METAL, _ROUGH_METAL, _ROUGH_GLASS, _PLASTIC = range(7)
# Below the first alpha a surface is smooth; from the second on, f32 resolves its lobe.
_SMOOTH, _LEAST = 1e-5, 2e-3
_WRAPS = {"repeat": 1, "clamp": 2, "mirror": 3}


class LeftError(Exception):
    """A feature that only the CPU supports; its text names it."""


def told(thing: object) -> str:
    """Return how a thing is called."""
    return type(thing).__name__


def constant(given: Any, what: str) -> tuple[float, float, float]:
    """Return a color that is the same everywhere.

    Raises
    ------
    LeftError
        If it is not.
    """
    if not isinstance(given, tuple):
        raise LeftError(f"{what} is a {told(given)}")
    return given


class Looks:
    """All materials of a scene, each once, and the numbers that they need."""

    def __init__(self) -> None:
        self._rows: list[NDArray[np.void]] = []
        self._known: dict[Material, int] = {}
        self._numbers: list[NDArray[np.float32]] = []
        self._count = 0
        self._tables: dict[float, tuple[int, float]] = {}

    def add(self, numbers: ArrayLike) -> int:
        """Keep numbers, and return where they begin."""
        array = np.ascontiguousarray(numbers, np.float32).reshape(-1)
        self._numbers.append(array)
        self._count += len(array)
        return self._count - len(array)

    def numbers(self) -> NDArray[np.float32]:
        """Return all of them."""
        return np.concatenate([*self._numbers, np.zeros(1, np.float32)])

    def array(self) -> NDArray[np.void]:
        """Return the rows of all materials, fronts and backs by turns."""
        return np.array(self._rows or [np.zeros((), MATERIAL)] * 2, MATERIAL)

    def number(self, material: Material, where: str) -> int:
        """Return where a material begins.

        Raises
        ------
        LeftError
            If it is none that the kernels know.
        """
        if material not in self._known:
            sides = (
                (material.front, material.back) if isinstance(material, TwoSided) else (material, material)
            )
            rows = [self._row(side, f"the {told(side)} of {where}") for side in sides]
            self._known[material] = len(self._rows)
            self._rows += rows
        return self._known[material]

    def _row(self, material: Material, what: str) -> NDArray[np.void]:
        row = np.zeros((), MATERIAL)
        row["picture"] = _NO
        if isinstance(material, Diffuse):
            row["kind"] = _DIFFUSE
            self._paint(row, material.reflectance, what)
        elif isinstance(material, Mirror):
            row["kind"] = _MIRROR
            self._paint(row, material.reflectance, what)
        elif isinstance(material, Dielectric):
            self._glass(row, material, what)
        elif isinstance(material, Conductor):
            self._metal(row, material, what)
        elif isinstance(material, Plastic):
            self._coat(row, material, what)
        else:
            raise LeftError(f"{what} has an unsupported type")
        return row

    def _paint(self, row: NDArray[np.void], given: Any, what: str) -> None:
        """Give a row its color, which may be a picture."""
        row["color"] = 1.0
        if not isinstance(given, ImageTexture):
            row["color"] = constant(given, f"the reflectance of {what}")
            return
        if given.filter != "bilinear":
            raise LeftError(f"the picture of {what} has the filter {given.filter!r}, not 'bilinear'")
        image = given.image[..., list(given.channels)].astype(np.float64)
        if given.image.dtype == np.uint8:
            image /= 255
        if given.decoded:
            image = np.where(image <= 0.04045, image / 12.92, ((image + 0.055) / 1.055) ** 2.4)
        height, width = image.shape[:2]
        wrap = _WRAPS[given.wrap[0]] + 4 * _WRAPS[given.wrap[1]]
        head = [width, height, wrap, *np.ravel(given.transform.matrix)]
        row["picture"] = self.add(np.concatenate([head, np.broadcast_to(image, (height, width, 3)).ravel()]))

    def _glass(self, row: NDArray[np.void], glass: Dielectric, what: str) -> None:
        if glass.interior is not None:
            raise LeftError(f"{what} has an interior medium")
        if not isinstance(glass.ior, float | int):
            raise LeftError(f"the index of refraction of {what} depends on wavelength")
        alpha = _alpha(glass, what)
        row["eta"] = glass.ior
        row["kind"] = _GLASS
        if alpha >= _SMOOTH and abs(glass.ior - 1) >= 1e-6:
            row["kind"], row["alpha"] = _ROUGH_GLASS, alpha
            self._give_back(row, alpha, float(glass.ior), glass.multiple_scattering)

    def _give_back(self, row: NDArray[np.void], alpha: float, eta: float, gives: bool) -> None:
        """Return the compensation for the energy that rough glass loses, by side: `Interface` of the core."""
        tables = [loss_table(alpha, own) if gives else np.zeros(ENTRIES) for own in (eta, 1 / eta)]
        row["losses"] = self.add(np.concatenate(tables))
        means = [mean_of(table) for table in tables]
        if min(means) > 0:
            through = [1 - mean_fresnel(own) for own in (eta, 1 / eta)]
            row["k"][:2] = [part * min(means) / mean for part, mean in zip(through, means, strict=True)]
            row["multiple"][:2] = [1 / (np.pi * mean) for mean in means]

    def _coat(self, row: NDArray[np.void], plastic: Plastic, what: str) -> None:
        alpha, eta = _alpha(plastic, what), float(plastic.ior)
        self._paint(row, plastic.reflectance, what)
        row["kind"], row["eta"] = _PLASTIC, eta
        mean = mean_fresnel(eta)
        if alpha >= _SMOOTH:
            if not plastic.multiple_scattering:
                raise LeftError(f"{what} is rough without multiple scattering")
            table = coat_table(alpha, eta)
            row["alpha"], row["losses"], mean = alpha, self.add(table), mean_of(table)
        row["k"][:2] = mean, mean_fresnel(1 / eta)

    def _metal(self, row: NDArray[np.void], metal: Conductor, what: str) -> None:
        alpha = _alpha(metal, what)
        row["kind"], row["color"] = _METAL, 1.0
        if metal.metal is not None:
            # An index of 0, which no metal has, stands for a table.
            table, row["color"] = reflectances(metal.metal)
            row["table"] = self.add(table)
        else:
            row["eta"], row["k"] = constant(metal.eta, f"eta of {what}"), constant(metal.k, f"k of {what}")
        if alpha >= _SMOOTH:
            row["kind"], row["alpha"] = _ROUGH_METAL, alpha
            row["losses"], average = self._losses(alpha if metal.multiple_scattering else 0.0)
            if average > 0:
                row["multiple"] = made_up(metal, average)

    def _losses(self, alpha: float) -> tuple[int, float]:
        """Return the start of the table of lost energy, and the mean loss; 0 if facets lose nothing."""
        if alpha not in self._tables:
            table = loss_table(alpha) if alpha else np.zeros(ENTRIES)
            self._tables[alpha] = self.add(table), mean_of(table)
        return self._tables[alpha]


def _alpha(material: Any, what: str) -> float:
    """Return the roughness of a material, alike in all directions, as its facets have it."""
    given = material.alpha if material.alpha is not None else material.roughness
    both = given if isinstance(given, tuple) else (given, given)
    if not all(isinstance(one, float | int) for one in both):
        raise LeftError(f"the roughness of {what} is a texture")
    if both[0] != both[1]:
        raise LeftError(f"{what} is anisotropic")
    alpha = float(both[0]) if material.alpha is not None else float(both[0]) ** 2
    if alpha >= _SMOOTH:
        if material.distribution != "ggx":
            raise LeftError(f"{what} has the distribution {material.distribution!r}")
        if alpha < _LEAST:
            raise LeftError(f"{what} is almost smooth, with an alpha of {alpha:g}")
    return alpha
