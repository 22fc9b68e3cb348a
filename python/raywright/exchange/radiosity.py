"""Radiosity of diffuse scenes."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, Literal, get_args, overload

from ..arrays import SeedLike, choice, seed_number, thread_limit
from ..scene.progress import BuildProgress, check_progress, watcher
from ..scene.scene import SceneLike
from .coincident import merged
from .copies import laid_out
from .patches import cut, exchanging
from .problem import Problem, lamps_of, stop_criteria
from .shooting import states as shooting_states
from .shooting import to_the_end
from .solution import Method, Per, RadiositySolution

Sides = Literal["front", "both"]


@overload
def radiosity(
    scene: SceneLike,
    per: Per = ...,
    method: Method = ...,
    error: float | None = ...,
    rays: int | None = ...,
    patch_size: float | None = ...,
    sides: Sides | None = ...,
    seed: SeedLike = ...,
    threads: int | None = ...,
    progress: BuildProgress = ...,
    states: Literal[False] = ...,
) -> RadiositySolution: ...


@overload
def radiosity(
    scene: SceneLike,
    per: Per = ...,
    method: Method = ...,
    error: float | None = ...,
    rays: int | None = ...,
    patch_size: float | None = ...,
    sides: Sides | None = ...,
    seed: SeedLike = ...,
    threads: int | None = ...,
    progress: BuildProgress = ...,
    *,
    states: Literal[True],
) -> Iterator[RadiositySolution]: ...


def radiosity(
    scene: SceneLike,
    per: Per = "face",
    method: Method = "stochastic",
    error: float | None = None,
    rays: int | None = None,
    patch_size: float | None = None,
    sides: Sides | None = None,
    seed: SeedLike = 0,
    threads: int | None = None,
    progress: BuildProgress = True,
    states: bool = False,
) -> RadiositySolution | Iterator[RadiositySolution]:
    """Solve for the diffuse interreflection of light between the surfaces of a scene (radiosity).

    Each face, or each patch of a face, has one value. `Radiosity` makes pictures of the solution.

    Parameters
    ----------
    scene : Scene, Mesh or anything else that Scene takes
        Scene of `Diffuse` surfaces, or `TwoSided` of them. Emissive surfaces, lights and environments all
        contribute. A curved shape is one patch; shading normals are ignored. Each copy of an `Instance` has
        its own patches, and takes their memory; moving copies are refused.
    per : {"face", "vertex"}
        "face": pictures show one value for each patch. "vertex": they interpolate linearly between corners,
        smoothly across patches of a shape.
    method : {"stochastic", "progressive", "matrix"}
        "stochastic" shoots all unshot light at once, along rays in proportion to its power, without a matrix
        (Neumann 1995; Bekaert 1999). "progressive" shoots from one patch after the other, always the one with
        the most unshot power (Cohen, Chen, Wallace and Greenberg 1988). "matrix" solves with `view_factors`,
        for some thousand patches at most.
    error : float, optional
        Target, as a share: of "stochastic", `RadiositySolution.error`, with the bound on unshot power below a
        tenth of it; of "progressive", that bound; of "matrix", the error of sampled view factors. By default
        0.01; for "stochastic" with `rays`, none; for "matrix", the default of `view_factors`.
    rays : int, optional
        Number of rays for emitted light, over all replicates; reflected light takes rays in proportion. The
        default follows from `error`; for "progressive" it is 64 for each patch, and at least 65536 for each
        replicate. For "matrix", it is the number for lights without a surface.
    patch_size : float, optional
        The longest side of a patch; each triangle is cut into n² similar ones. By default faces are not cut.
    sides : {"front", "both"}, optional
        Sides of faces that take part: fronts, with black backs, or both, as in `Path`. By default both;
        "matrix" supports fronts only. With both, two coincident faces with opposite normals are the two sides
        of one face, each with the material of its own.
    seed : int, Generator or SeedSequence
        Seed of the random numbers; the same seed gives the same bits.
    threads : int, optional
        Number of threads; one per core by default.
    progress : bool or callable
        As for `Scene.build`: the share of the work.
    states : bool
        True to return a generator of intermediate solutions, for "progressive": one after each shot, the
        final one last.

    Returns
    -------
    RadiositySolution
        Or a generator of them, with ``states=True``.

    Raises
    ------
    ValueError
        If something is out of its range, a surface is not diffuse, reflects all of a channel or has no end,
        the scene has a medium, or nothing shines.
    TypeError
        If an argument has the wrong type.

    Warns
    -----
    RuntimeWarning
        If faces coincide: they count as one face.

    See Also
    --------
    Radiosity : Renders the solution.
    view_factors : The geometry of the exchange.

    Notes
    -----
    If flat faces touch front to front, such as a box and the floor beneath, the covered part of each
    exchanges light with the other alone. Faces without area exchange nothing. Eight independent replicates
    give the standard error, which includes a bound on unshot power. In each, emitted power equals absorbed,
    escaped and unshot power, to rounding. Iterations stop by the bound ‖unshot‖ / (1 - the greatest
    reflectance).

    The error of "stochastic" is the root mean square over area of the errors of single patches. The rays that
    land on a patch determine its irradiance, so N patches take about N / `error`² rays for emitted light, and
    more in proportion to reflected light. Halving `patch_size` takes four times the rays: a large one with
    ``per="vertex"`` costs less. Means over many patches have smaller errors.

    Examples
    --------
    >>> scene, _ = rw.scenes.cornell_box()
    >>> solution = rw.radiosity(scene, error=0.2, progress=False)
    >>> bool(solution.error < 0.25), solution.method
    (True, 'stochastic')
    """
    choice("per", per, get_args(Per))
    choice("method", method, get_args(Method))
    if sides is not None:
        choice("sides", sides, get_args(Sides))
    if method == "matrix" and sides == "both":
        raise ValueError(
            "sides must be 'front' for method='matrix', which has view factors of front sides only"
        )
    wanted, limit = stop_criteria(error, rays)
    seed = seed_number(seed)
    threads = thread_limit(threads)
    check_progress(progress)
    if not isinstance(states, bool):
        raise TypeError(f"states must be True or False, got {states!r}")
    if states and method != "progressive":
        raise ValueError(f"states requires method='progressive', got {method!r}")
    scene = exchanging(scene)
    both = method != "matrix" and sides != "front"
    laid, covered = merged(laid_out(scene), both)
    cuts, lamps = cut(laid.scene, patch_size), lamps_of(scene)
    problem = Problem.of(laid, cuts, both, per, seed, threads, lamps, covered=covered)
    problem.check()
    if states:
        return shooting_states(problem, wanted or 0.01, limit)
    solve = _by_matrix if method == "matrix" else to_the_end
    with watcher(progress, "radiosity") as report:
        return solve(problem, method, wanted, limit, report)


def _by_matrix(
    problem: Problem,
    method: Method,
    error: float | None,
    rays: int | None,
    report: Callable[[float], Any] | None,
) -> RadiositySolution:
    from .matrix import solve

    return solve(problem, error, rays)
