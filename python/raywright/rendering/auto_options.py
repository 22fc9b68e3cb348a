"""Choice of the path tracer's options by a pilot."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from itertools import product
from typing import Any

from .. import _core
from ..cameras import AnyCamera
from ..descriptions import changed
from ..integrators import Path
from ..scene.scene import Scene
from .choices import Limits, expected
from .filters import Filter
from .plan import Choice

# The side of patches that share paths, where any do; that of larger ones, which are tried where those pay;
# and the relMSE of a pilot above which light is taken to be found by few paths, as behind a keyhole.
_REUSE, _LARGE, _NOISY = 4, 8, 0.2
# How much longer samples take that share paths, or that aim, by `benches/choices.py`, in times of a plain
# one. It is not measured on the spot: the same has to be chosen everywhere, every time.
_COSTS: dict[str, dict[Any, float]] = {
    "reuse": {1: 0.0, 2: 0.3, _REUSE: 0.5, _LARGE: 1.3},
    "guiding": {"none": 0.0, "photons": 1.2, "learned": 1.2},
}
# Paths in media are longer, so that sharing and guiding cost relatively less.
_MEDIA = "smoke and haze"
_COSTS_AMONG: dict[str, dict[Any, float]] = {
    "reuse": {1: 0.0, 2: 0.1, _REUSE: 0.2, _LARGE: 0.5},
    "guiding": {"none": 0.0, "photons": 0.3, "learned": 0.5},
}
# An option must improve by this factor, since a pilot may be wrong.
_BETTER = 0.9
# One in this many samples of a render may go to a pilot of each option.
_SHARE = 64
_PLAIN: dict[str, Any] = {"reuse": 1, "guiding": "none"}
_MORE: dict[str, Any] = {"reuse": _REUSE, "guiding": "photons"}
_NEVER = {
    "reuse": "no paths can be shared here",
    "guiding": "no light comes by way of mirrors or glass",
}


class StoppedError(Exception):
    """A render was stopped from elsewhere."""


def followed(
    path: Path,
    scene: Scene,
    camera: AnyCamera,
    limits: Limits,
    threads: int | None,
    clamp: float | None,
    filter: Filter,
    begun: Mapping[str, Any],
    look: Callable[[], None] | None,
) -> tuple[Path, tuple[Choice, ...], float]:
    """Return a path tracer that leaves nothing open, rows of the plan, and the seconds it took to choose.

    Parameters
    ----------
    path : Path
        The integrator named by the user.
    scene, camera, threads, clamp, filter
        Arguments of `render`.
    limits : tuple
        Samples, error and seconds; None where there is no limit.
    begun : dict
        Settings of the checkpoint to continue; empty if the render begins.
    look : callable, optional
        Called during a pilot; it may raise `StoppedError` to end it: then the plain options are chosen.
    """
    named = {name: getattr(path, name) for name in _PLAIN}
    why = {name: "as named" for name, value in named.items() if value is not None}
    for name, plain in _PLAIN.items():
        if name not in why and type(begun.get(name)) is type(plain):
            named[name], why[name] = begun[name], "as the checkpoint has it"
    pixels = camera.width * camera.height
    open_ = [name for name in _PLAIN if name not in why]
    if open_ and expected(limits, pixels) * pixels < _SHARE * _core.PILOT:
        why |= dict.fromkeys(open_, "the picture has too few samples to send a pilot")
        open_ = []
    compiled = scene._compiled() if open_ else None
    began = time.perf_counter()
    fixed = {name: _PLAIN[name] if value is None else value for name, value in named.items()}
    chosen = fixed
    if compiled is not None:
        try:
            *some, learns = _core.chances(compiled, path, threads, look)
            can, learns = dict(zip(_PLAIN, some, strict=True)), learns and "guiding" in open_
            why |= {name: _NEVER[name] for name in open_ if not can[name]}
            open_ = [name for name in open_ if can[name]]

            costs = _COSTS_AMONG if _MEDIA in scene.plan().needed else _COSTS

            def cost(way: Mapping[str, Any]) -> float:
                return 1 + sum(costs[name][value] for name, value in way.items())

            def sent(ways: list[dict[str, Any]]) -> list[float]:
                paths = [changed(path, **way) for way in ways]
                errors = _core.pilot(compiled, camera, paths, threads, clamp, filter, look)
                return [error * cost(way) for error, way in zip(errors, ways, strict=True)]

            # A single option left needs no pilot.
            ways, worth = _tried(fixed, open_, learns, sent, cost) if open_ or learns else ([fixed], [0.0])
        except StoppedError:
            why |= dict.fromkeys(open_, "it was stopped before a pilot was back")
        else:
            if min(worth) < _BETTER * worth[0]:
                chosen = ways[worth.index(min(worth))]
            if learns and any(way["guiding"] == "learned" for way in ways):
                open_ = list(dict.fromkeys((*open_, "guiding")))
            why |= {name: _told(name, ways, worth) for name in open_}
    rows = tuple(Choice(name, str(chosen[name]), why[name]) for name in _PLAIN)
    return changed(path, **chosen), rows, time.perf_counter() - began


def _tried(
    fixed: dict[str, Any],
    names: list[str],
    learns: bool,
    sent: Callable[[list[dict[str, Any]]], list[float]],
    cost: Callable[[Mapping[str, Any]], float],
) -> tuple[list[dict[str, Any]], list[float]]:
    """Return variants, the plain one first, with the error times time of each, as pilots measured it."""
    ways = [fixed | dict(zip(names, way, strict=True)) for way in product(*_options(names))]
    worth = sent(ways)
    least = ways[worth.index(min(worth))]
    if learns and min(worth) > _NOISY * cost(least):
        # Training pays only where few paths find the light.
        learned = [
            least | {"reuse": reuse, "guiding": "learned"}
            for reuse in sorted({fixed["reuse"], least["reuse"]})
        ]
        before, *after = sent([least, *learned])
        ways += learned
        worth += [min(worth) * one / before for one in after]
        least = ways[worth.index(min(worth))]
    if "reuse" in names and least["reuse"] == _REUSE:
        larger = least | {"reuse": _LARGE}
        small, large = sent([least, larger])
        if min(worth) > _NOISY * cost(least):
            # If few paths find the light, few are shared, so that larger patches take no more time.
            large *= cost(least) / cost(larger)
        if large < _BETTER * small:
            ways.append(larger)
            worth.append(min(worth) * large / small)
    return ways, worth


def _options(names: list[str]) -> list[tuple[Any, Any]]:
    return [(_PLAIN[name], _MORE[name]) for name in names]


def _told(name: str, ways: list[dict[str, Any]], worth: list[float]) -> str:
    """Return the result of a pilot for one variant."""
    with_, without = (
        min(w for way, w in zip(ways, worth, strict=True) if (way[name] != _PLAIN[name]) is more)
        for more in (True, False)
    )
    if without == 0:
        return "a pilot found no error"
    return f"by a pilot, error times time is {with_ / without:.2g} of what it is without"
