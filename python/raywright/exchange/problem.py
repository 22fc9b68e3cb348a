"""The radiosity problem, and the solution from replicates."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import _core
from ..arrays import integer, number
from ..scene.scene import Scene
from .coincident import NOTHING, Covered, merged
from .copies import LaidOut, laid_out
from .patches import named
from .solution import Floats, Method, Per, RadiositySolution, RadiosityStep

# Independent solutions, whose spread is the error: with 7 degrees of freedom it is known to a quarter of its
# value.
REPLICATES = 8
EMITTED, UNSHOT, ESCAPED, BEHIND = range(4)


def lamps_of(scene: Scene) -> Scene | None:
    """Return a scene of the lights that are not surfaces, and nothing else; None if there are none."""
    if not scene.lights and scene.environment is None:
        return None
    return Scene([], scene.lights, scene.environment)


def stop_criteria(error: float | None, rays: int | None) -> tuple[float | None, int | None]:
    """Return the target error and the maximum number of rays, checked; None where it is not given."""
    wanted = None if error is None else number("error", error)
    if wanted is not None and wanted <= 0:
        raise ValueError(f"error must be greater than 0, got {error}")
    return wanted, None if rays is None else integer("rays", rays, 1, 2**50)


@dataclass
class Problem:
    """Patches that exchange light, and the core that shoots it."""

    laid: LaidOut
    core: _core.RadiosityShots
    cuts: NDArray[np.uint32]
    both: bool
    has_lamps: bool
    per: Per
    seed: int
    threads: int | None
    emission: Floats
    reflectance: Floats
    areas: Floats
    covered: Covered = NOTHING
    began: float = field(default_factory=time.monotonic)
    history: list[RadiosityStep] = field(default_factory=list)

    @classmethod
    def of(
        cls,
        scene: Scene | LaidOut,
        cuts: NDArray[np.uint32],
        both: bool,
        per: Per,
        seed: int,
        threads: int | None,
        lamps: Scene | None,
        looks: tuple[Floats, Floats] | None = None,
        covered: Covered = NOTHING,
    ) -> Problem:
        """Return that of a scene, or of one that is laid out, lit by the lights of another without shapes.

        `looks` are emission and reflectance in place of the scene's own, and `covered` the coincident faces
        of the flattened scene.
        """
        light = None if lamps is None else lamps._compiled()
        if isinstance(scene, Scene):
            laid, covered = merged(laid_out(scene), both)
        else:
            laid = scene
        core = _core.RadiosityShots(laid.scene._compiled(), light, cuts, both, looks, threads)
        if looks is None and covered.before is not None:
            own = _looks_of_sides(core, covered, cuts, threads)
            core = _core.RadiosityShots(laid.scene._compiled(), light, cuts, both, own, threads)
        areas = np.tile(core.areas, 2 if both else 1)
        parts = core.emission, core.reflectance, areas
        made = cls(laid, core, cuts, both, lamps is not None, per, seed, threads, *parts, covered)
        if looks is None:
            made.emission, made.reflectance = map(made._with_covered, (core.emission, core.reflectance))
        return made

    def check(self) -> None:
        """Refuse problems whose solution has no bound.

        Raises
        ------
        ValueError
            If nothing shines, or a patch reflects all light of a channel.
        """
        if not (self.has_lamps or self.emission.any()):
            raise ValueError(
                "the scene has no light: no participating shape has an emission, and there are no lights"
            )
        most = self.reflectance.max(axis=1)
        if most.max() >= 1.0:
            row = named(self.laid, self.cuts, self.both)[int(most.argmax())]
            raise ValueError(
                f"shape {row['shape']} reflects all light of a channel, so unshot radiosity is unbounded: "
                "give it a reflectance below 1"
            )

    def begin(self, number: int, light_rays: int) -> None:
        """Begin all replicates anew, by other rays for each number."""
        seed = (self.seed + number * 0x9E3779B97F4A7C15) % 2**64
        self.core.begin(seed, REPLICATES, max(light_rays, 1), self.threads)

    def note(self, rays: int) -> float:
        """Return the bound on unshot power, as a share of all, and append it to the history."""
        arrived, books = self.core.arrived.mean(axis=0), self.core.books.mean(axis=0)
        bound = self.bound(arrived, books[UNSHOT])
        self.history.append(RadiosityStep(time.monotonic() - self.began, rays, bound))
        return bound

    def note_end(self, rays: int) -> None:
        """Keep with the history that nothing is left."""
        self.history.append(RadiosityStep(time.monotonic() - self.began, rays, 0.0))

    def bound(self, arrived: Floats, unshot: NDArray[Any]) -> float:
        """Return ‖unshot‖ / (1 - reflectance) over ‖radiosity‖, powers of the channel where it is most."""
        whole = (self.emission * self.areas[:, None] + self.reflectance * arrived).sum(axis=0)
        short = unshot / (1.0 - self.reflectance.max(axis=0))
        return float(np.max(short[whole > 0] / whole[whole > 0], initial=0.0))

    def solution(self, method: Method, arrived: Floats, books: Floats, unshot: Floats) -> RadiositySolution:
        """Return the mean of replicates of the arrived power, (R, N, 3) W, with its standard error.

        `books` are the emitted, unshot, escaped power and that absorbed by black backs, (R, 4, 3) W, and
        `unshot` is the unshot power of each patch, (R, N, 3) W.
        """
        irradiance = self.per_area(arrived.mean(axis=0))
        spread = self.per_area(arrived.std(axis=0, ddof=1) / np.sqrt(len(arrived)))
        short = self.shortfall(unshot.mean(axis=0))
        return self.solved(method, irradiance, np.hypot(spread, short), books.mean(axis=0))

    def per_area(self, power: Floats) -> Floats:
        """Return power, (..., N, 3) W, over the area of each patch; 0 where there is none."""
        areas = np.broadcast_to(self.areas[:, None], power.shape)
        return np.divide(power, areas, out=np.zeros_like(power), where=areas > 0)

    def shortfall(self, unshot: Floats) -> Floats:
        """Return a bound on the irradiance that unshot power may add to each patch, (N, 3) W/m².

        Unshot radiosities u finally add the irradiance (F + F R F + ...) u, with the reflectances R. Rows of
        F add up to 1 at most, so that no irradiance is more than max u / (1 - max R); nor is any power more
        than all that is unshot over (1 - max R).
        """
        room = 1.0 - self.reflectance.max(axis=0)
        greatest = self.per_area(unshot).max(axis=0) / room
        whole = np.broadcast_to(unshot.sum(axis=0) / room, unshot.shape)
        return np.where(self.areas[:, None] > 0, np.minimum(greatest, self.per_area(whole)), 0.0)

    def solved(
        self, method: Method, irradiance: Floats, irradiance_error: Floats, books: Floats
    ) -> RadiositySolution:
        """Return the solution of given irradiances and their errors."""
        absorbed = ((1.0 - self.reflectance) * irradiance * self.areas[:, None]).sum(axis=0)
        escaped = books[ESCAPED] + books[BEHIND]
        corners = self.core.corners
        irradiance, irradiance_error = (self._with_covered(of) for of in (irradiance, irradiance_error))
        return RadiositySolution(
            radiosity=self.emission + self.reflectance * irradiance,
            irradiance=irradiance,
            standard_error=self.reflectance * irradiance_error,
            irradiance_error=irradiance_error,
            emission=self.emission,
            reflectance=self.reflectance,
            areas=self.areas,
            patches=named(self.laid, self.cuts, self.both),
            corners=np.concatenate([corners, corners]) if self.both else corners,
            cuts=self.cuts,
            mirrored=self.laid.mirrored,
            per=self.per,
            method=method,
            emitted=_triple(books[EMITTED]),
            absorbed=_triple(absorbed),
            escaped=_triple(escaped),
            unshot=_triple(books[UNSHOT]),
            history=tuple(self.history),
            dropped=int(np.count_nonzero(self._face_areas() == 0)),
            surface_area=self._surface_area(),
        )

    def _starts(self) -> NDArray[np.int64]:
        """Return the number of the first patch of each face."""
        counts = self.cuts.astype(np.int64) ** 2
        return np.cumsum(counts) - counts

    def _face_areas(self) -> Floats:
        starts = self._starts()
        return np.add.reduceat(self.areas[: len(self.areas) // (2 if self.both else 1)], starts)

    def _surface_area(self) -> float:
        """Return the area of all shapes but copies, coincident faces counted each."""
        is_own = self.laid.copy < 0
        covered = self.covered.areas[is_own[self.covered.faces]]
        return float(self._face_areas()[is_own].sum() + covered.sum())

    def _with_covered(self, values: Floats) -> Floats:
        """Return values of patches, (N, K), with the means of their stand-ins for coincident faces."""
        if not len(self.covered):
            return values
        values, starts = values.copy(), self._starts()
        count = len(self.areas) // (2 if self.both else 1)
        whole = np.maximum(self._face_areas(), np.finfo(np.float64).tiny)
        means = [
            np.add.reduceat(part * self.areas[:count, None], starts) / whole[:, None]
            for part in np.split(values, len(values) // count)
        ]
        for part, of_covered in enumerate(self.covered.sides(means)):
            values[part * count + starts[self.covered.faces]] = of_covered
        return values


def _looks_of_sides(
    core: _core.RadiosityShots, covered: Covered, cuts: NDArray[np.uint32], threads: int | None
) -> tuple[Floats, Floats]:
    """Return emission and reflectance of all sides, where turned faces stand for the backs of others."""
    assert covered.before is not None
    ones = np.ones(len(cuts), np.uint32)
    whole = _core.RadiosityShots(covered.before.scene._compiled(), None, ones, True, None, threads)
    faces = np.repeat(np.arange(len(cuts)), cuts.astype(np.int64) ** 2)
    backs = np.isin(faces, covered.by[np.repeat(covered.turned, np.diff([*covered.starts, len(covered.by)]))])
    rows = len(faces) + np.flatnonzero(backs)

    def of(mine: Floats, before: Floats) -> Floats:
        values = mine.copy()
        values[rows] = covered.with_backs(before)[len(cuts) + faces[backs]]
        return values

    return of(core.emission, whole.emission), of(core.reflectance, whole.reflectance)


def _triple(values: Floats) -> tuple[float, float, float]:
    red, green, blue = values.tolist()
    return red, green, blue
