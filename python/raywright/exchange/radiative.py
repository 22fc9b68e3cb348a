"""Radiative exchange of gray surfaces: how much heat each gains or loses."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any, Literal, TypeAlias, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import SeedLike, choice, integer, number, real_array, seed_number, thread_limit
from ..lights import ConstantEnvironment
from ..query.tabular import Tabular
from ..scene.progress import BuildProgress, check_progress, watcher
from ..scene.scene import Scene, SceneLike
from .coincident import Covered, merged
from .copies import LaidOut, laid_out
from .patches import exchanging
from .problem import BEHIND, ESCAPED, REPLICATES, Problem, lamps_of, stop_criteria
from .shooting import to_the_end
from .solution import Floats, RadiositySolution

PerFace: TypeAlias = ArrayLike | Sequence[ArrayLike] | Mapping[int, ArrayLike]
ExchangeMethod: TypeAlias = Literal["matrix", "stochastic"]

# W·m⁻²·K⁻⁴: exact in the SI since 2019, by 2 π⁵ k⁴ / (15 h³ c²).
STEFAN_BOLTZMANN = 5.670374419184429e-8
# Net fluxes are small differences, so that the unshot flux must be negligible.
_BIAS = 1e-5
# Kelvin: its fourth power, the heat, still is finite.
_HOTTEST = 1e70
# Rays per replicate that test whether a room is closed: per face on average, and at least.
_LOOKS, _LEAST_LOOKS = 8, 2**13
# Up to this many faces the matrix is the default.
_SMALL = 2048


@dataclass(frozen=True, eq=False, repr=False)
class RadiativeExchange(Tabular):
    """Heat exchange of surfaces by radiation. Made by `radiative_exchange`; `patches` is read-only.

    There is a row for each face of the scene, or for each side: all fronts, then all backs.

    Attributes
    ----------
    flux : (N,) float64
        Net flux that a surface loses, W/m²: radiosity minus irradiance. A negative value is a gain.
    power : (N,) float64
        Net power that a surface loses, W: flux times area.
    standard_error : (N,) float64
        Standard error of `flux`; 0 without sampling. In a closed room at one temperature it is almost 0.
    radiosity, irradiance : (N,) float64
        Leaving (emitted and reflected) and arriving flux of heat, W/m²; light of the scene is in
        `absorbed_light`.
    absorbed_light : (N,) float64
        Absorbed flux of the scene's lights, environment and emission, W/m²; `flux` is reduced by it.
    areas : (N,) float64
        Areas in m²; 0 for a face that coincides with one before it, which counts for both.
    patches : (N,) structured
        "shape", "copy", "face" and "side" of each row, as in `RadiositySolution`.
    temperature, emissivity : (N,) float64
        As given.
    escaped : float
        Power of heat that leaves the scene or reaches black backs, W.
    dropped : int
        Number of faces without exchange of their own: without area, not finite, or coincident with another.

    See Also
    --------
    radiative_exchange : Makes it.

    Examples
    --------
    >>> plate = rw.Mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])
    >>> heat = rw.radiative_exchange(plate, 300.0, progress=False)
    >>> heat.flux.round(3).tolist(), heat.areas.tolist()
    ([459.3, 459.3], [0.5, 0.5])
    """

    flux: Floats
    power: Floats
    standard_error: Floats
    radiosity: Floats
    irradiance: Floats
    absorbed_light: Floats
    areas: Floats
    patches: NDArray[Any]
    temperature: Floats
    emissivity: Floats
    escaped: float
    dropped: int

    def of(self, shape: int) -> float:
        """Return the net power that a shape loses, W.

        Parameters
        ----------
        shape : int
            Index in ``scene.shapes``.

        Returns
        -------
        float

        Raises
        ------
        ValueError
            If there is no such shape.

        Examples
        --------
        >>> plate = rw.Mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])
        >>> round(rw.radiative_exchange(plate, 300.0, progress=False).of(0), 3)
        459.3
        """
        last = int(self.patches["shape"].max())
        return float(self.power[self.patches["shape"] == integer("shape", shape, 0, last)].sum())

    def to_dict(self) -> dict[str, NDArray[Any]]:
        """Return flat arrays by name, an entry for each row, with the fields of `patches`.

        Returns
        -------
        dict
            An array for each column.

        Examples
        --------
        >>> plate = rw.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
        >>> rw.radiative_exchange(plate, 300.0, progress=False).to_dict()["temperature"].tolist()
        [300.0]
        """
        columns = {name: self.patches[name] for name in ("shape", "copy", "face", "side")}
        columns["area"] = self.areas
        for name in ("temperature", "emissivity", "flux", "power", "standard_error"):
            columns[name] = getattr(self, name)
        heat = ("radiosity", "irradiance", "absorbed_light")
        return columns | {name: getattr(self, name) for name in heat}

    def __len__(self) -> int:
        return len(self.flux)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, RadiativeExchange):
            return NotImplemented
        pairs = ((getattr(self, field.name), getattr(other, field.name)) for field in fields(self))
        return all(np.array_equal(a, b) for a, b in pairs)

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return f"RadiativeExchange({len(self)} surfaces, {self.power.sum():.4g} W lost in all)"


def radiative_exchange(
    scene: SceneLike,
    temperature: PerFace,
    emissivity: PerFace = 1.0,
    sky_temperature: float | None = None,
    absorptance: PerFace | None = None,
    method: ExchangeMethod | None = None,
    error: float | None = None,
    rays: int | None = None,
    sides: Literal["front", "both"] = "front",
    seed: SeedLike = 0,
    threads: int | None = None,
    progress: BuildProgress = True,
) -> RadiativeExchange:
    """Return the net radiative flux of each face, for gray and diffuse surfaces.

    Each surface emits ε times the Stefan-Boltzmann constant times T⁴, absorbs the share ε of the arriving
    flux and reflects the rest: the net radiation method (Siegel and Howell, "Thermal Radiation Heat
    Transfer"). Materials are ignored.

    Parameters
    ----------
    scene : Scene, Mesh or anything else that Scene takes
        The surfaces; a curved shape is one surface. The faces of an `Instance` are those of all its copies,
        one after the other.
    temperature : float, list, dict or array
        Temperatures in kelvin, at least 0: a number for all; an array with a value for each face, shape after
        shape; or a list, or a dict by shape index, of numbers or of arrays with a value for each face.
    emissivity : the same
        Above 0, and at most 1.
    sky_temperature : float, optional
        Temperature of black surroundings, in kelvin, beyond the scene; 0 K by default.
    absorptance : the same as emissivity, optional
        Absorbed share of the scene's light: from its lights, its environment and its emission. By default the
        emissivity. Light is the mean of red, green and blue, in W: ``DirectionalLight(down, 800.0)`` is a sun
        of 800 W/m².
    method : {"matrix", "stochastic"}, optional
        By `view_factors`, or by rays as in `radiosity`. By default "matrix" for up to 2048 faces.
    error, rays : optional
        As of `radiosity`.
    sides : {"front", "both"}
        "front": backs are black and cold. "both": backs take part, as for fins; it requires "stochastic". Two
        coincident faces with opposite normals are then the two sides of one face, each with the values of its
        own.
    seed, threads, progress
        As of `radiosity`.

    Returns
    -------
    RadiativeExchange

    Raises
    ------
    ValueError
        If a number is out of its range, there are too few or too many of them, a surface has no end, or the
        scene has a medium.
    TypeError
        If an argument has the wrong type.

    Warns
    -----
    RuntimeWarning
        If faces coincide: they count as one face, with the values of the first of them.

    See Also
    --------
    view_factors : The geometry of the exchange.
    radiosity : The same for light.

    Examples
    --------
    A black plate at 300 K under a black sky at 280 K loses 110.767 W/m² (Stefan and Boltzmann):

    >>> plate = rw.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> heat = rw.radiative_exchange(plate, 300.0, sky_temperature=280.0, progress=False)
    >>> round(heat.flux[0].item(), 3), round(5.670374419e-8 * (300**4 - 280**4), 3)
    (110.767, 110.767)
    """
    scene = exchanging(scene, diffuse=False)
    choice("sides", sides, ("front", "both"))
    both = sides == "both"
    laid, covered = merged(laid_out(scene), both)
    faces = laid.counts.tolist()
    if method is None:
        method = "matrix" if sum(faces) <= _SMALL and not both else "stochastic"
    choice("method", method, get_args(ExchangeMethod))
    if method == "matrix" and both:
        raise ValueError(
            "sides must be 'front' for method='matrix', which has view factors of front sides only"
        )
    kelvin = _per_face("temperature", temperature, faces)
    _check("temperature", kelvin, kelvin >= 0, "at least 0")
    _check("temperature", kelvin, kelvin <= _HOTTEST, f"at most {_HOTTEST:g}")
    gray = _per_face("emissivity", emissivity, faces)
    _check("emissivity", gray, (gray > 0) & (gray <= 1), "above 0 and at most 1")
    light = gray if absorptance is None else _per_face("absorptance", absorptance, faces)
    _check("absorptance", light, (light > 0) & (light <= 1), "above 0 and at most 1")
    sky = None
    if sky_temperature is not None:
        above = number("sky_temperature", sky_temperature)
        _check("sky_temperature", np.array(above), np.array(above >= 0), "at least 0")
        _check("sky_temperature", np.array(above), np.array(above <= _HOTTEST), f"at most {_HOTTEST:g}")
        sky = Scene([], environment=ConstantEnvironment(STEFAN_BOLTZMANN * above**4 / np.pi))
    wanted, limit = stop_criteria(error, rays)
    seed = seed_number(seed)
    workers = thread_limit(threads)
    check_progress(progress)
    kelvin, gray, light = (
        covered.with_backs(np.tile(part, 2)) if both else part for part in (kelvin, gray, light)
    )
    cuts = np.ones(sum(faces), np.uint32)
    sent = gray * STEFAN_BOLTZMANN * kelvin**4

    def solve(lamps: Scene | None, emission: Floats, absorbing: Floats) -> RadiositySolution:
        looks = _three(emission), _three(1.0 - absorbing)
        problem = Problem.of(laid, cuts, both, "face", seed, workers, lamps, looks, covered)
        if method == "matrix":
            from .matrix import solve as by_matrix

            return by_matrix(problem, wanted, limit)
        with watcher(progress, "exchange") as report:
            return to_the_end(problem, "stochastic", wanted, limit, report, _BIAS)

    coldest, doubt = 0.0, 0.0
    if method == "stochastic":
        looks = _three(np.ones(len(gray))), _three(1.0 - gray)
        problem = Problem.of(laid, cuts, both, "face", seed, workers, None, looks, covered)
        share = _lost(problem)
        if share is not None:
            coldest = STEFAN_BOLTZMANN * float(kelvin[problem.areas > 0].min(initial=_HOTTEST)) ** 4
            doubt = coldest * share
    heat = solve(sky, np.maximum(sent - gray * coldest, 0.0), gray)
    arrives, off = heat.irradiance[:, 0] + coldest, np.hypot(heat.irradiance_error[:, 0], doubt)
    absorbed, light_off = _light(laid, covered, cuts, both, light, solve)
    leaves = heat.radiosity[:, 0] + coldest
    # A face without area loses nothing; a coincident face takes the irradiance of its partner.
    is_own = heat.areas > 0
    is_own.reshape(-1, sum(faces))[:, covered.faces] = True
    flux = np.where(is_own, sent - gray * arrives - absorbed, 0.0)
    return RadiativeExchange(
        flux=flux,
        power=flux * heat.areas,
        standard_error=np.hypot(gray * off, light_off),
        radiosity=leaves.copy(),
        irradiance=arrives.copy(),
        absorbed_light=absorbed,
        areas=heat.areas.copy(),
        patches=heat.patches,
        temperature=kelvin,
        emissivity=gray,
        escaped=heat.escaped[0],
        dropped=heat.dropped,
    )


def _lost(problem: Problem) -> float | None:
    """Return the standard error of the share that a room loses, if no ray leaves it; None if one does.

    In a closed room, surfaces of one temperature exchange nothing, whatever their emissivities. Only the
    excess over the coldest surface is then shot, and errors are shares of that.
    """
    rays = max(_LOOKS * len(problem.areas), _LEAST_LOOKS)
    problem.begin(0, 1)
    problem.core.shoot_all(rays, problem.threads)
    if problem.core.books[:, [ESCAPED, BEHIND]].any():
        return None
    # Rule of three: the share is below 3 / n at 95 %, so that half of this is its standard error.
    return 1.5 / (REPLICATES * rays)


def _light(
    laid: LaidOut,
    covered: Covered,
    cuts: NDArray[np.uint32],
    both: bool,
    absorbing: Floats,
    solve: Any,
) -> tuple[Floats, Floats]:
    """Return the absorbed flux of the scene's own light, W/m², and its error."""
    shines = any(getattr(shape, "emission", None) is not None for shape in laid.scene.shapes)
    lamps = lamps_of(laid.scene)
    if lamps is None and not shines:
        return np.zeros(len(absorbing)), np.zeros(len(absorbing))
    emission = np.zeros(len(absorbing))
    if shines:
        own = Problem.of(laid, cuts, both, "face", 0, None, None, covered=covered)
        emission = own.emission.mean(axis=1)
    found = solve(lamps, emission, absorbing)
    return absorbing * found.irradiance.mean(axis=1), absorbing * found.irradiance_error.mean(axis=1)


def _three(values: Floats) -> Floats:
    """Return the same in all channels."""
    return np.ascontiguousarray(np.repeat(values[:, None], 3, axis=1))


def _per_face(name: str, given: PerFace, faces: list[int]) -> Floats:
    """Return one number per face of an argument that may have several forms."""
    if isinstance(given, Mapping):
        wrong = [key for key in given if key not in range(len(faces))]
        missing = [shape for shape in range(len(faces)) if shape not in given]
        if wrong or missing:
            raise ValueError(
                f"{name} must have an entry for each of {len(faces)} shapes by number, "
                f"{'has none for ' + str(missing[0]) if missing else 'got one for ' + repr(wrong[0])}"
            )
        given = [given[shape] for shape in range(len(faces))]
    if isinstance(given, list | tuple):
        if len(given) != len(faces):
            raise ValueError(f"{name} must have {len(faces)} entries, one per shape, got {len(given)}")
        parts = [
            _numbers(f"{name}[{i}]", one, count)
            for i, (one, count) in enumerate(zip(given, faces, strict=True))
        ]
        return np.concatenate(parts)
    return _numbers(name, given, sum(faces))


def _numbers(name: str, given: Any, count: int) -> Floats:
    array = real_array(name, given).astype(np.float64)
    if array.shape not in ((), (count,)):
        raise ValueError(
            f"{name} must be one number, or one for each of {count} faces, got shape {array.shape}"
        )
    if not np.isfinite(array).all():
        raise ValueError(f"{name} must be finite, got {array[~np.isfinite(array)].flat[0]:g}")
    return np.broadcast_to(array, count).copy()


def _check(name: str, values: Floats, fine: NDArray[np.bool_], allowed: str) -> None:
    if not fine.all():
        raise ValueError(f"{name} must be {allowed}, got {values[~fine][0]:g}")
