"""Radiosity of diffuse scenes."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, Literal, get_args, overload

from ..arrays import SeedLike, choice, integer, number, seed_number, thread_limit
from ..scene.progress import BuildProgress, check_progress, watcher
from ..scene.scene import SceneLike
from .coincident import merged
from .copies import laid_out
from .patches import cut, exchanging
from .problem import Problem, lamps_of
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

    Faces, or the patches that they are cut into, have one value each. `Radiosity` makes pictures of the
    solution.

    Parameters
    ----------
    scene : Scene, Mesh or anything else that a Scene is made of
        Scene of `Diffuse` surfaces, or `TwoSided` of them. Surfaces that shine and all other lights and
        environments count. A shape that is no mesh is one patch; shading normals do not count. Each copy of
        an `Instance` has patches of its own, and so takes the memory that its shapes would take; copies that
        move have no solution.
    per : {"face", "vertex"}
        "face": pictures have one value a patch. "vertex": they are linear between corners, where patches of
        the same shape meet without an edge.
    method : {"stochastic", "progressive", "matrix"}
        "stochastic" shoots all unshot light at once, along rays in proportion to its power, without a matrix
        (Neumann 1995; Bekaert 1999). "progressive" shoots from one patch after the other, always that which
        has most (Cohen, Chen, Wallace and Greenberg 1988). "matrix" solves with `view_factors`, for some
        thousand patches at most.
    error : float, optional
        Target, as a share: of "stochastic", `RadiositySolution.error`, with the bound on unshot power below a
        tenth of it; of "progressive", that bound; of "matrix", the error of view factors found by rays. By
        default 0.01; for "stochastic" with `rays`, as these give; for "matrix", the default of
        `view_factors`.
    rays : int, optional
        Number of rays of the first light, all replicates together; reflected light takes rays in proportion.
        The default is as many as `error` needs, for "progressive" 64 a patch and at least 65536 for each
        replicate. For "matrix", it is the number for lights that are no surfaces.
    patch_size : float, optional
        The longest side of a patch; each triangle is cut into n² that are similar to it. By default faces are
        not cut.
    sides : {"front", "both"}, optional
        Which sides of faces take part: those that normals point to, with black backs, or both, as `Path` has
        them. By default both, and for "matrix", which knows fronts only, these. With both, two faces that lie
        in each other and look opposite ways are the two sides of one, each as the front of its face is.
    seed : int, Generator or SeedSequence
        Which random numbers; the same seed gives the same bits.
    threads : int, optional
        Number of threads; one a core by default.
    progress : bool or callable
        As for `Scene.build`: the share of the work.
    states : bool
        Whether to return a generator of intermediate solutions, for "progressive": one a shot, the final one
        last.

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
        If something is of the wrong kind.

    Warns
    -----
    RuntimeWarning
        If faces coincide: they are one, which exchanges light once.

    See Also
    --------
    Radiosity : Renders the solution.
    view_factors : The geometry of the exchange.

    Notes
    -----
    If flat faces touch front to front, as a box and the floor beneath do, the covered part of each exchanges
    light with the other alone. Faces without area exchange nothing. Eight replicates, each of rays of its
    own, give the standard error; the most that unshot power may add is a part of it. Within each, emitted
    power is absorbed, has left or is unshot, to rounding. Iterations end by ‖unshot‖ / (1
    - the greatest reflectance).

    The error of "stochastic" is the root mean square over the area, of patches each by itself: the irradiance
    of a patch is known by the rays that land there, so that N patches take about N / `error`² rays for the
    light that is shot first, and as much more as is reflected. Half as long sides take four times the rays: a
    large `patch_size` with ``per="vertex"`` costs less than small ones. Means over many patches are known
    better.

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
    wanted = None if error is None else number("error", error)
    if wanted is not None and wanted <= 0:
        raise ValueError(f"error must be greater than 0, got {error}")
    limit = None if rays is None else integer("rays", rays, 1, 2**50)
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
