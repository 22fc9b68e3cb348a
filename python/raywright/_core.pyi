"""The compiled core. Everything here takes validated, C-contiguous arrays; the public face is the package."""

from collections.abc import Callable, Iterable, Sequence
from typing import Any, TypeAlias, final

import numpy as np
from numpy.typing import NDArray

_Floats: TypeAlias = NDArray[np.floating[Any]]
_Numbers: TypeAlias = float | NDArray[np.float64]
# Origins, directions, t_min, t_max, the leading shape of all, threads, time.
_Rays: TypeAlias = tuple[
    _Floats,
    _Floats,
    _Numbers,
    _Numbers,
    tuple[int, ...],
    int | None,
    _Numbers | None,
    NDArray[np.bool_] | None,
]

__all__ = [
    "PILOT",
    "VERSION",
    "AcceleratorInfo",
    "CompiledScene",
    "FlatScene",
    "GridBlocks",
    "Interactions",
    "Job",
    "KernelContest",
    "MeshTopology",
    "RadiosityShots",
    "Rendering",
    "Sight",
    "aovs",
    "batch_for",
    "camera_rays",
    "camera_rays_through",
    "chances",
    "coincident_faces",
    "cone_coverage",
    "cones",
    "cores",
    "daylight_power",
    "denoise_candidates",
    "denoise_settle",
    "exr_huffman",
    "exr_integrate",
    "exr_piz",
    "exr_run_lengths",
    "film_reflectance",
    "first_hits",
    "implicit_trouble",
    "interactions",
    "leading_numbers",
    "matrix_trouble",
    "mesh_topology",
    "metal_index",
    "metals",
    "photons",
    "pilot",
    "plan",
    "points",
    "polygon_trouble",
    "preview",
    "random_numbers",
    "sections",
    "shape_area",
    "shape_bounds",
    "simd",
    "singular_transform",
    "smooth_spectrum",
    "spawn_rays",
    "spectrum_luminance",
    "spectrum_rgb",
    "student",
    "tree_boxes",
    "triangulate_polygons",
    "view_factor_matrix",
    "view_factor_rows",
    "weld",
    "weld_rounding",
]

def cores() -> int:
    """Return the number of threads that are used where none is given.

    One for each core that the process may use, by its affinity and the quota of its control group, and at
    most ``os.process_cpu_count()``; ``RAYON_NUM_THREADS`` sets another.
    """

def simd() -> str:
    """Return the SIMD level the kernels run at; ``RAYWRIGHT_SIMD`` forces one.

    "scalar", "neon", "sse2", "avx2" or "avx512".
    """

def singular_transform(transform: NDArray[np.float64]) -> tuple[int, str] | None:
    """Find the first of (4,4) or (N,4,4) matrices that has no inverse, and why; None if all have one."""

@final
class AcceleratorInfo:
    """Statistics of a built accelerator."""

    @property
    def kind(self) -> str: ...
    @property
    def precision(self) -> str: ...
    @property
    def primitives(self) -> int: ...
    @property
    def nodes(self) -> int: ...
    @property
    def leaves(self) -> int: ...
    @property
    def depth(self) -> int: ...
    @property
    def bytes(self) -> int: ...
    @property
    def build_seconds(self) -> float: ...
    @property
    def sah_cost(self) -> float: ...

@final
class CompiledScene:
    """A scene ready for rays, read by attribute from a `raywright.Scene` (shapes, lights, environment)."""

    def __new__(
        cls, scene: Any, accelerator: Any, progress: Callable[[float], object] | None = None
    ) -> CompiledScene: ...
    def refitted(self, scene: Any) -> CompiledScene | None:
        """Fit the accelerator to a scene of the same faces; None if that cannot be done."""
    def intersect(
        self,
        rays: _Rays,
        out: tuple[NDArray[Any] | None, ...] | None = None,
        counted: tuple[list[bool] | None, bool] | None = None,
        fields: int = ...,
    ) -> tuple[Any, Any, Any, Any, Any]:
        """Closest hits of rays of leading shape `shape`: t, shape_id and primitive (...), uv (..., 2).

        And in a scene with instances, instance (...).

        ``origins`` and ``directions`` have shape (..., 3) and are float32 or float64, each of either type;
        ``t_min`` and ``t_max`` are floats or arrays. Each has one row, or one for each ray. Rays of two or
        more dimensions are an image, and traced in tiles. ``out`` is written to and given back.
        ``counted`` says of each shape whether it counts, and whether only what faces the ray does.
        ``fields`` has a bit for each of the five arrays to return; the others are None.
        """
    def intersect_plain(
        self, origins: Any, directions: Any, t_min: Any, t_max: Any
    ) -> tuple[Any, Any, Any, Any, Any] | None:
        """Return `intersect` of rays that need no conversion, on meshes; None for others."""
    def occluded_plain(
        self, origins: Any, directions: Any, t_min: Any, t_max: Any
    ) -> NDArray[np.bool_] | None:
        """Return `occluded` of rays that need no conversion; None for others."""
    def occluded(
        self,
        rays: _Rays,
        out: NDArray[np.bool_] | None = None,
        counted: tuple[list[bool] | None, bool] | None = None,
    ) -> NDArray[np.bool_]:
        """Return whether each ray hits anything. Arguments as `intersect`."""
    def optical_depth(self, rays: _Rays) -> NDArray[np.float64]:
        """Return the optical depths of the media along rays, (..., 3)."""
    def intersect_all(
        self,
        rays: _Rays,
        counted: tuple[list[bool] | None, bool] | None = None,
    ) -> tuple[
        NDArray[np.int64],
        NDArray[np.float64],
        NDArray[np.int32],
        NDArray[np.int32],
        NDArray[np.float64],
        NDArray[np.int32] | None,
    ]:
        """All hits of N rays: splits (N+1,), t (K,), shape_id (K,), primitive (K,), uv (K,2).

        And in a scene with instances, instance (K,).
        """
    def count_hits(
        self,
        rays: _Rays,
    ) -> NDArray[np.int32]:
        """Return the number of hits of each ray."""
    def traversal_cost(
        self,
        rays: _Rays,
    ) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
        """Nodes visited and primitives tested for each ray's closest hit."""
    def contains(
        self,
        points: _Floats,
        shape: tuple[int, ...],
        threads: int | None,
        shapes: list[bool] | None = None,
        tolerance: float | None = None,
        is_even_odd: bool = False,
    ) -> NDArray[np.bool_]:
        """Return whether points of leading shape `shape` are inside a closed shape or on it."""
    def inverted(self, shapes: list[bool] | None = None, tolerance: float | None = None) -> list[int]:
        """Return the meshes whose normals point into them."""
    def nearest(
        self,
        points: _Floats,
        max_distance: _Numbers,
        shape: tuple[int, ...],
        threads: int | None,
        shapes: list[bool] | None = None,
    ) -> tuple[
        NDArray[np.float64],
        NDArray[np.float64],
        NDArray[np.int32],
        NDArray[np.int32],
        NDArray[np.float64],
        NDArray[np.int32] | None,
    ]:
        """Closest points: distance, position (..., 3), shape_id, primitive, uv (..., 2), instance.

        The last is None where there are no instances.
        """
    def positions(
        self, shape_id: NDArray[np.int32], primitive: NDArray[np.int32], uv: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Points on primitives: (N,3), NaN for misses."""
    def sites(
        self,
        shape_id: NDArray[np.int32],
        primitive: NDArray[np.int32],
        uv: NDArray[np.float64],
        position: NDArray[np.float64],
        instance: NDArray[np.int32] | None,
    ) -> NDArray[np.float64]:
        """Find unit normals at points, and bound the error of each coordinate: (N,4), NaN for misses."""
    def normals(self, shape_id: NDArray[np.int32], primitive: NDArray[np.int32]) -> NDArray[np.float64]:
        """Find unit geometric normals: (N,3), NaN for misses."""
    def errors(self, shape_id: NDArray[np.int32], primitive: NDArray[np.int32]) -> NDArray[np.float64]:
        """Bound how far each coordinate of `positions` is from the surface: (N,1), NaN for misses."""
    def tangent_balls(
        self,
        points: NDArray[np.float64],
        ways: NDArray[np.float64],
        radius: NDArray[np.float64],
        threads: int | None,
    ) -> NDArray[np.float64]:
        """Shrink balls that touch meshes at (N,3) points, middles along unit ways, till empty: (N,) radii."""
    @property
    def shapes(self) -> tuple[Any, ...]:
        """The shapes that it was compiled from, in their order."""
    @property
    def is_rounded(self) -> bool:
        """True if rounding to float32 has moved vertices."""
    @property
    def loss(self) -> tuple[float, float] | None:
        """Displacement of vertices by rounding, and its share of their mesh's extent, where it is a loss."""
    @property
    def growth(self) -> float:
        """The accelerator's SAH cost over what it was when it was built."""
    @property
    def accelerator(self) -> AcceleratorInfo: ...
    @property
    def curved(self) -> bool:
        """True if anything in it is no mesh."""

    @property
    def dropped(self) -> int:
        """Faces left out because a corner is NaN or infinite."""
    @property
    def bounds(self) -> NDArray[np.float64] | None:
        """((3,) least, (3,) greatest) as (2,3); None for an empty scene."""
    @property
    def bytes(self) -> int:
        """Bytes held by the compiled scene: accelerators, faces, vertices with all they have, transforms."""

@final
class Job:
    """All that a picture is made by but for the scene, which is compiled when it is needed: read once."""

    def __new__(
        cls,
        scene: Any,
        camera: Any,
        integrator: Any,
        seed: int,
        adaptive: bool,
        clamp: float | None,
        sampler: Any,
        filter: Any,
        transparent: bool,
        apart: bool,
    ) -> Job: ...
    def patch(self, scene: CompiledScene) -> int:
        """Return the side of the square patches of pixels whose samples the integrator takes together."""
    def expose(self, scene: CompiledScene, request: bytes, threads: int | None) -> bytes:
        """Take the samples that a request of `Rendering.request` wants. One thread is the calling one."""

@final
class Sight:
    """A view of a render during a pass; None between passes."""

    def __new__(cls, rendering: Rendering) -> Sight: ...
    @property
    def is_open(self) -> bool:
        """True during a pass, and just after it."""
    @property
    def is_done(self) -> bool:
        """True if it is at rest: viewers are waited for."""
    def outline(self) -> Rendering | None:
        """Return the render without its pixels."""
    def copy(self) -> Rendering | None:
        """Return all of the render as it is now, to be looked at."""
    @property
    def rgb(self) -> NDArray[np.float32] | None: ...
    @property
    def counts(self) -> NDArray[np.uint32] | None: ...
    @property
    def amiss(self) -> tuple[int, int] | None:
        """Number of samples that were not finite or negative, and number of clamped samples."""

@final
class Rendering:
    """A render: its picture so far, and its state."""

    def __new__(cls, job: Job, threads: int | None, patch: int) -> Rendering: ...
    @staticmethod
    def from_bytes(data: bytes, job: Job, threads: int | None, patch: int) -> Rendering:
        """Decode the bytes of `to_bytes`; a ValueError gives the reason if bytes are invalid."""
    @staticmethod
    def most_bytes(job: Job) -> int:
        """Return how many bytes `to_bytes` gives at most."""
    def to_bytes(self) -> bytes: ...
    @property
    def rgb(self) -> NDArray[np.float32]: ...
    @property
    def uncertainty(self) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.float32]] | None:
        """Standard error (H,W,3), the same by pixels around too, and degrees (H,W); None where unknown."""
    @property
    def error(self) -> tuple[float, float, float]:
        """Estimate of relMSE, and the low and high end of its 95 % interval; NaN where unknown."""
    @property
    def history(self) -> NDArray[np.float64]:
        """(K,3): seconds, samples, error."""
    @property
    def seconds(self) -> float: ...
    def spend(self, seconds: float) -> None:
        """Count time that was spent on it elsewhere."""
    @property
    def samples(self) -> int: ...
    @property
    def counts(self) -> NDArray[np.uint32]:
        """Samples of each pixel (H,W)."""
    @property
    def trusted(self) -> bool:
        """True if the error estimate rests on many samples that agree on it; True where there is none."""
    @property
    def carried(self) -> tuple[int, float] | None:
        """Fewest finds with more than half of the error estimate, and their share; None if there are many."""
    @property
    def dropped(self) -> int:
        """Samples that were NaN, infinite or negative, and are counted as black."""
    @property
    def clamped(self) -> tuple[int, float]:
        """Samples that were clamped, and the share of the picture's radiance that this took."""
    def cover(
        self, job: Job, scene: CompiledScene, ranks: int, samples: int | None, threads: int | None
    ) -> tuple[NDArray[np.float32], NDArray[np.int32], NDArray[np.float32]]:
        """Return what covers pixels, by the samples that there are, or by so many each, with their filter.

        The share (H,W) that anything does, and of so many shapes that cover most of a pixel (H,W,ranks) the
        numbers, -1 where there are fewer, and shares.
        """
    def go_on(
        self,
        job: Job,
        scene: CompiledScene,
        threads: int | None,
        samples: int | None,
        error: float | None,
        seconds: float | None,
        pause: float | None,
        progress: Callable[[float, int, float, bool], None] | None,
        look: Callable[[], bool | None] | None,
    ) -> bool:
        """Go on until the first of `samples` (per pixel), `error` (relMSE) or `seconds` is met: True.

        False if that took more than `pause` seconds: what has been begun is done then, and it can go on.
        ``progress`` is called with (seconds, samples done, error estimate or NaN, whether that is trusted)
        after every pass.
        Signals are checked ten times a second or more, and ``look`` is called as often; an exception raised
        by a handler, by ``progress`` or by ``look`` ends the render at once and is passed on. Even then it
        can be gone on with. Where ``look`` says True after a pass, the render is left too.
        """
    def bias(
        self,
        job: Job,
        scene: CompiledScene,
        threads: int | None,
        look: Callable[[], None] | None,
    ) -> list[NDArray[np.float32]] | None:
        """Bias of each pixel (H,W,3) by how far light is gathered from, and its standard error; or None."""
    @property
    def halves(self) -> tuple[NDArray[np.float32], NDArray[np.float32]] | None:
        """Independent quarters of the samples (4,H,W,3), and variances (2,H,W,3) of the halves they make.

        None where they were not kept, or where a quarter has no whole batch.
        """
    @property
    def patch(self) -> int:
        """The side of the squares of pixels that take samples together."""
    @property
    def aim(self) -> int:
        """Samples after the pass that is being worked on; as many as there are if none is."""
    @property
    def tiles(self) -> int:
        """Number of tiles of the picture."""
    @property
    def block(self) -> int:
        """Samples that are added up by themselves."""
    @property
    def appends(self) -> bool:
        """True if samples that fill blocks can be requested before earlier ones are there."""
    @property
    def rate(self) -> float:
        """Seconds that a sample of all pixels took in the last pass; 0 before there was one."""
    def next_aim(
        self,
        samples: int | None,
        error: float | None,
        seconds: float | None,
        after: int,
        elapsed: float,
        rate: float,
    ) -> int:
        """Return the samples after the pass that follows `after` samples, at that time and rate.

        `after` itself is the end.
        """
    def begin(self, aim: int) -> None:
        """Begin the pass to so many samples, or go on with it."""
    def end(self, seconds: float) -> tuple[float, int, float, bool]:
        """End the pass, for which all samples are there: the row of the history, and whether to trust it."""
    def request(self, first: int, count: int, before: int | None, samples: int) -> bytes:
        """Ask `Job.expose` for the samples of some tiles up to a number.

        With ``before``, a multiple of `block`, for those that follow so many others, whether these are there
        or not.
        """
    def take(self, answer: bytes) -> None:
        """Add the samples that `Job.expose` took."""
    def add(self, count: int, sums: NDArray[np.float64], dropped: int) -> None:
        """Add so many samples of each pixel: ``sums`` (H*W,9) are sums, sums of squares and the largest.

        ``dropped`` of them were no radiance, and are 0 there. The film has single samples, not clamped.
        """

PILOT: int
"""The most samples that a pilot takes of each path."""
VERSION: str

def student(level: float, degrees: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return how many standard errors either way hold a mean in so many cases, by degrees of freedom."""

def chances(
    scene: CompiledScene, path: Any, threads: int | None, look: Callable[[], None] | None
) -> tuple[bool, bool, bool]:
    """Return whether paths can be reused in a scene, guided by photons, and guided by what they learn.

    Signals are checked, and ``look`` is called, as by `Rendering.go_on`.
    """

def pilot(
    scene: CompiledScene,
    camera: Any,
    paths: Sequence[Any],
    threads: int | None,
    clamp: float | None,
    filter: Any,
    look: Callable[[], None] | None,
) -> list[float]:
    """Return about the relMSE that each of some paths leaves, told from a few parts of a picture.

    It depends on scene, camera, clamp and filter alone. Signals are checked, and ``look`` is called, as by
    `Rendering.go_on`.
    """

def aovs(
    scene: CompiledScene, camera: Any, names: list[str], samples: int, seed: int, threads: int | None
) -> list[NDArray[np.float64]]:
    """Pictures of channels by their names, (H, W) or (H, W, n), in the order asked for.

    Raises ValueError for a name that is not known.
    """

def plan(scene: CompiledScene) -> list[tuple[str, bool, str]]:
    """Return the kernel that shades the scene, and rows of a feature, its presence, and the consequence."""

def denoise_candidates(
    halves: dict[str, Any], features: NDArray[np.float64], threads: int | None
) -> NDArray[np.float32]:
    """Return each half of a picture as it is and filtered in some ways, (2, ways, H, W, 3).

    ``halves`` has ``quarters`` and ``variances`` of `Rendering.halves`, the ``samples`` of a pixel and the
    ``patch``; ``features`` are two independent pictures of the first hit, (2, H, W, 7).
    """

def denoise_settle(
    halves: dict[str, Any], candidates: NDArray[np.float32], threads: int | None
) -> tuple[NDArray[np.float32], NDArray[np.float32], tuple[float, float, float], bool]:
    """Return a picture of the best candidates, how far pixels are off, relMSE, and whether to trust it."""

def batch_for(samples: int | None) -> int:
    """Return the samples of a batch for a number of samples a pixel, if that is known."""

def camera_rays(
    camera: Any, offsets: NDArray[np.float64], single: bool, lens: NDArray[np.float64], time: _Numbers
) -> tuple[_Floats, _Floats]:
    """Origins and directions (H,W,3) through the pixels; row 0 is the top.

    They are float32 if ``single``, else float64.
    ``offsets`` is where in the pixel: (0, 0) is its upper left, (1, 1) its lower right; ``lens`` where in the
    lens, ``time`` when while the shutter is open, each from 0 to 1: one for all, or (H,W,2) and (H,W).
    """

def camera_rays_through(
    camera: Any, points: NDArray[np.float64], lens: NDArray[np.float64], time: _Numbers
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Origins and directions (N,3) through points (N,2) of the film, in pixels from its left and its top.

    ``lens`` and ``time`` are those of `camera_rays`: one for all, or (N,2) and (N,).
    """

@final
class FlatScene:
    """A compiled scene as flat arrays, and the core's part in kernels over these."""

    def __new__(cls, scene: CompiledScene, accelerator: Any, quality: str, prototypes: bool) -> FlatScene: ...
    @property
    def nodes(self) -> NDArray[np.uint32]:
        """(K, 8), the bytes of nodes: least corner, index, greatest corner, count."""
    @property
    def triangles(self) -> NDArray[np.uint32]:
        """(M, 12), the bytes of triangles: corner, primitive, edge, largest, other edge, instance."""
    @property
    def instances(self) -> NDArray[np.uint32]:
        """(I, 16), the bytes of instances: a (3, 4) matrix, first node, node after, primitive, 0."""
    @property
    def own(self) -> tuple[int, int]:
        """Number of nodes and of triangles of the scene's own tree."""
    @property
    def unbounded(self) -> NDArray[np.uint32]:
        """Primitives without end: (U,)."""
    @property
    def first(self) -> list[int]:
        """The first primitive of each shape, and how many there are in all."""
    @property
    def depth(self) -> int: ...
    @property
    def centre(self) -> NDArray[np.float64]: ...
    @property
    def scale(self) -> float: ...
    def rays(
        self,
        rays: _Rays,
    ) -> NDArray[np.float32]:
        """Make rays ready for kernels: (N, 8), origin, t_min, direction and t_max in box units."""
    def intersect(
        self,
        rays: _Rays,
        candidates: NDArray[np.uint32],
    ) -> tuple[
        tuple[
            NDArray[np.float64],
            NDArray[np.int32],
            NDArray[np.int32],
            NDArray[np.float64],
            NDArray[np.int32] | None,
        ],
        tuple[int, int],
    ]:
        """Find the closest hits among candidates (N, 4), as `CompiledScene.intersect` gives them.

        And the number of rays with candidates to decide, and of rays left to the accelerator.
        """
    def occluded(
        self,
        rays: _Rays,
        told: NDArray[np.uint32],
    ) -> tuple[NDArray[np.bool_], tuple[int, int]]:
        """Find whether rays hit anything, from their candidates (N,).

        And the number of rays to decide, and of rays left to the accelerator.
        """

@final
class GridBlocks:
    """Numbers on a grid, one or three a point; zeros take no memory."""

    def __new__(
        cls,
        size: Sequence[int],
        coloured: bool,
        parts: Iterable[tuple[tuple[int, ...], NDArray[np.float32]]],
    ) -> GridBlocks: ...
    def bytes(self) -> int:
        """Return the memory held."""

    def kept(self) -> NDArray[np.int64]:
        """Return the corners of blocks that are not all 0, the greater beyond the last point, (N,2,3)."""

    def part(self, low: Sequence[int], high: Sequence[int]) -> NDArray[np.float32]:
        """Return the numbers between two corners, all of a point after one another."""

    def greatest(self) -> float:
        """Return the greatest number."""

    def same(self, other: GridBlocks) -> bool:
        """Return whether all numbers are those of another."""

@final
class RadiosityShots:
    """Patches of a scene, and the replicates of a radiosity solution."""

    def __new__(
        cls,
        scene: CompiledScene,
        lamps: CompiledScene | None,
        cuts: NDArray[np.uint32],
        both: bool,
        looks: tuple[NDArray[np.float64], NDArray[np.float64]] | None = None,
        threads: int | None = None,
    ) -> RadiosityShots: ...
    def begin(self, seed: int, replicates: int, light_rays: int, threads: int | None) -> None:
        """Begin so many replicates anew, each with so many rays for light that comes from no surface."""

    def shoot_all(self, rays: int, threads: int | None) -> None:
        """Shoot all unshot power; were it all there is, each replicate took so many rays."""

    def shoot_greatest(self, count: int, rays: int, threads: int | None) -> None:
        """Shoot so many sides of patches, each time that of most unshot power."""

    @property
    def areas(self) -> NDArray[np.float64]: ...
    @property
    def emission(self) -> NDArray[np.float64]: ...
    @property
    def reflectance(self) -> NDArray[np.float64]: ...
    @property
    def corners(self) -> NDArray[np.float64]: ...
    @property
    def arrived(self) -> NDArray[np.float64]: ...
    @property
    def unshot(self) -> NDArray[np.float64]: ...
    @property
    def books(self) -> NDArray[np.float64]: ...
    @property
    def rays(self) -> int: ...

def photons(
    scene: CompiledScene,
    count: int,
    max_depth: int | None,
    roulette_depth: int,
    seed: int,
    threads: int | None,
) -> tuple[
    tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]],
    tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.int64], NDArray[np.int64]],
    tuple[NDArray[np.uint64], NDArray[np.uint64]],
    tuple[tuple[float, float, float], tuple[float, float, float], tuple[float, float, float]],
]:
    """Return light at each surface that it comes to: positions, directions, normals and powers (K,3).

    Then shape_id, primitive, path and bounces (K,), bits of specular bounces and of those in media, and the
    flux that is emitted, escapes and is absorbed by media. Signals are checked.
    """

def cone_coverage(
    scene: CompiledScene,
    origins: _Floats,
    directions: _Floats,
    half_angle: _Numbers,
    t_max: _Numbers,
    shape: tuple[int, ...],
    threads: int | None,
) -> NDArray[np.float64]:
    """Return the share of each cone that is covered, of the given shape; arguments as `cones`."""

def cones(
    scene: CompiledScene,
    origins: _Floats,
    directions: _Floats,
    half_angle: _Numbers,
    t_max: _Numbers,
    shape: tuple[int, ...],
    threads: int | None,
) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.int32], NDArray[np.int32]]:
    """Find faces in N cones, nearest first: splits (N+1,), distance (K,), shape_id (K,), primitive (K,).

    Arguments as `CompiledScene.intersect`; `half_angle` is in degrees.
    """

def first_hits(
    scene: CompiledScene, camera: Any, offsets: NDArray[np.float64], threads: int | None
) -> tuple[NDArray[np.float64], NDArray[np.int32], NDArray[np.int32], NDArray[np.float64], int]:
    """Closest hits of the rays through all pixels: t, shape_id and primitive (H,W), uv (H,W,2).

    The last is for how many pixels the accelerator was asked. ``offsets`` as `camera_rays`.
    """

def preview(
    scene: CompiledScene,
    camera: Any,
    light: tuple[float, float, float] | None,
    is_place: bool,
    ambient: float,
    background: tuple[float, float, float],
    out: NDArray[Any],
    threads: int | None,
) -> None:
    """Draw a picture into ``out``, (H,W,3) of uint8 or float32, by a ray and a shadow ray a pixel.

    ``light`` is a direction towards a light, or its position if ``is_place``; None is a light at the eye.
    """

@final
class KernelContest:
    """The ray-triangle routines side by side, on N pairs of a ray and a triangle.

    ``origins`` and ``directions`` are (N,3); ``corners`` is (N,9), one corner after the other.
    """

    def __new__(
        cls,
        origins: NDArray[np.float32],
        directions: NDArray[np.float32],
        corners: NDArray[np.float32],
    ) -> KernelContest: ...
    @property
    def routines(self) -> list[tuple[str, int]]:
        """Name of each routine, and the bytes that it keeps of a triangle."""
    def round(self) -> list[float]:
        """Test all pairs with each routine in turn: the seconds that each takes."""
    def answers(self, routine: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Where one routine finds hits: t (N,), inf for a miss, and uv (N,2)."""

def shape_bounds(shape: Any) -> list[list[float]]:
    """Least and greatest corner of a shape under its transform, rounded outwards."""

def shape_area(shape: Any) -> float:
    """Area of a shape under its transform."""

def matrix_trouble(matrix: list[list[float]]) -> str | None:
    """Why an affine matrix (4 rows of 4) has no inverse, or None if it has one."""

def exr_integrate(data: bytes) -> NDArray[np.uint8]:
    """Sum the differences of an EXR chunk, and interleave its bytes."""

def exr_run_lengths(data: bytes, count: int) -> bytes:
    """Decode so many bytes of run lengths."""

def exr_huffman(data: bytes, count: int) -> NDArray[np.uint16]:
    """Decode so many words of OpenEXR's Huffman code."""

def exr_piz(data: bytes, channels: Sequence[tuple[int, int, int]]) -> NDArray[np.uint16]:
    """Decode a PIZ chunk, channel by channel, given the columns, rows and words a sample of each."""

def metals() -> list[tuple[str, str]]:
    """Tell the metals that are known: symbol and name."""

def metal_index(name: str) -> list[list[float]]:
    """Return the measured index of a metal: rows of wavelength (nm), real and imaginary part."""

def daylight_power() -> list[float]:
    """Tell the power of daylight (D65) at each nm from 360 to 830, 100 at 560."""

def film_reflectance(rows: Sequence[Sequence[float]]) -> list[float]:
    """Tell the share of light that films reflect, by rows of wavelength, thickness, cosine and indices."""

def smooth_spectrum(
    colour: Sequence[float], bounded: bool, looked_up: bool, wavelengths: Sequence[float]
) -> list[float]:
    """Tell the smooth spectrum of a colour at wavelengths (nm): exactly, or as textures look it up."""

def spectrum_luminance(rows: Sequence[Sequence[float]]) -> float:
    """Tell the luminance of light by wavelength (nm); 1 where it is 1 everywhere."""

def spectrum_rgb(rows: Sequence[Sequence[float]], of_daylight: bool) -> list[float]:
    """Tell the linear Rec. 709 colour of shares of daylight, or of even light, at rising wavelengths (nm)."""

def polygon_trouble(
    outline: Sequence[Sequence[float]], holes: Sequence[Sequence[Sequence[float]]]
) -> str | None:
    """Describe the error of a polygon; None if nothing is."""

def leading_numbers(text: bytes, skipped: Sequence[bytes]) -> tuple[NDArray[np.float64], bool]:
    """Return the numbers at the beginning of a text, and whether nothing else follows them.

    Words of `skipped` may stand between them.
    """

def triangulate_polygons(
    points: NDArray[np.float64], corners: NDArray[np.int64], counts: NDArray[np.int64]
) -> NDArray[np.int64]:
    """Return the triangles of polygons with so many corners each, (T, 3) indices of corners."""

def implicit_trouble(expression: str, min: Sequence[float], max: Sequence[float]) -> str | None:
    """Describe the error of an expression or its box; None if nothing is."""

@final
class Interactions:
    def __len__(self) -> int: ...
    def take(self, indices: NDArray[np.int64]) -> Interactions: ...
    @property
    def t(self) -> NDArray[np.float64]: ...
    @property
    def shape_id(self) -> NDArray[np.int32]: ...
    @property
    def primitive_id(self) -> NDArray[np.int32]: ...
    @property
    def uv(self) -> NDArray[np.float64]: ...
    @property
    def albedo(self) -> NDArray[np.float64]: ...
    @property
    def ior(self) -> NDArray[np.float64]: ...
    @property
    def position(self) -> NDArray[np.float64]: ...
    @property
    def normal(self) -> NDArray[np.float64]: ...
    @property
    def shading_normal(self) -> NDArray[np.float64]: ...
    @property
    def emission(self) -> NDArray[np.float64]: ...
    def spawn_rays(self, directions: _Floats) -> NDArray[np.float64]: ...
    def evaluate(self, directions: _Floats) -> tuple[NDArray[np.float64], NDArray[np.float64]]: ...
    def single(
        self, is_through: bool
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]: ...
    def sample_bsdf(
        self, choice: _Numbers, u: _Numbers
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]: ...
    def sample_light(
        self, choice: _Numbers, u: _Numbers
    ) -> tuple[list[NDArray[np.float64]], NDArray[np.float64], NDArray[np.float64]]: ...
    def light_pdf(self, before: Interactions) -> NDArray[np.float64]: ...

def interactions(scene: CompiledScene, origins: _Floats, directions: _Floats, time: _Numbers) -> Interactions:
    """Find the hits of rays of unit direction: (N,3) origins and directions, and a time for all or each."""

def random_numbers(
    seed: int, pixel: NDArray[np.uint32], sample: NDArray[np.uint32], dimension: int, pair: bool
) -> NDArray[np.float64]:
    """One number, or a pair, of a dimension of each sample of a pixel: (N,) or (N,2)."""

def spawn_rays(
    position: NDArray[np.float64],
    error: NDArray[np.float64],
    normal: NDArray[np.float64],
    directions: _Floats,
    which: NDArray[np.int64] | None,
    shape: tuple[int, ...],
) -> NDArray[np.float64]:
    """Where rays of leading shape `shape` start that leave N points along some directions: (..., 3).

    ``which`` says which point each leaves; without it, all are left in turn, over and over. ``directions``
    has one row, or one for each ray.
    """

def points(
    scene: CompiledScene,
    shape_id: NDArray[np.int32],
    primitive: NDArray[np.int32],
    instance: NDArray[np.int32] | None,
    uv: NDArray[np.float64],
    t: NDArray[np.float64],
    origins: _Floats,
    directions: _Floats,
    time: _Numbers,
    ray: NDArray[np.int64] | None,
) -> tuple[NDArray[np.float64], ...]:
    """All about some hits, NaN for misses.

    Position, error, normal, shading normal, dp/du, dp/dv, dn/du and dn/dv. `ray` says which ray each is of,
    where they are not in turn.
    """

@final
class MeshTopology:
    """Topology of the faces of a mesh."""

    @property
    def volumes(self) -> list[float]: ...
    @property
    def is_oriented(self) -> list[bool]: ...
    @property
    def cracks(self) -> list[list[int]]: ...
    @property
    def junctions(self) -> list[int]: ...
    @property
    def closed(self) -> int: ...
    @property
    def open(self) -> int: ...
    @property
    def inner(self) -> int: ...
    @property
    def duplicates(self) -> int: ...
    @property
    def degenerate(self) -> int: ...
    @property
    def turned(self) -> int: ...
    @property
    def tolerance(self) -> float: ...

def mesh_topology(vertices: _Floats, faces: NDArray[np.uint32], tolerance: float | None) -> MeshTopology:
    """Return how the faces of a mesh hang together."""

def sections(
    vertices: _Floats,
    faces: NDArray[np.uint32],
    origins: NDArray[np.float64],
    normals: NDArray[np.float64],
    even_odd: bool,
    tolerance: float | None,
) -> list[tuple[NDArray[np.float64], list[int], list[bool], float]]:
    """Return points (K, 3), splits, which lines are closed, and the area, of each plane."""

def weld(vertices: _Floats, faces: NDArray[np.uint32], tolerances: NDArray[np.float64]) -> NDArray[np.uint32]:
    """Return the vertex that stands for each."""

def weld_rounding(vertices: _Floats, faces: NDArray[np.uint32]) -> float:
    """Return how close corners of a mesh are that differ by rounding."""

def tree_boxes(
    scene: CompiledScene,
) -> tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.float64]] | None:
    """Return depth (K,), primitives (K,), -1 for inner nodes, and corners (K, 24) of a tree's boxes."""

def coincident_faces(
    scene: CompiledScene,
    touching: bool,
) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], NDArray[np.float64]]:
    """Return pairs of faces that share a part of one plane (K,2), and the shared area.

    The areas in common (K,), whether both look the same way (K,), whether they touch front to front (K,), if
    `touching`, and the areas of all faces (N,).
    """

def view_factor_matrix(
    scene: CompiledScene,
    rays: tuple[int, int],
    errors: tuple[float | None, float | None],
    seed: int,
    threads: int | None,
    progress: Callable[[float], object] | None,
) -> tuple[
    NDArray[np.float64],
    NDArray[np.float64],
    tuple[NDArray[np.int64], NDArray[np.float64]],
    tuple[int, int, int],
    int,
    NDArray[np.bool_],
]:
    """Return areas (N,), view factors (N,N), what is sampled, and numbers of pairs.

    Those are the pairs that are closed, hidden and sampled. Sampled pairs of faces (K,2), and standard errors
    (K,) of the area of each times its view factor to the other. Last, the number of rays, and which rows are
    sampled and add up to one (N,). ``errors`` are the greatest standard error of a factor, and that as a
    share of the greatest factor of its rows. ``rays`` are those between two faces, and those of a row.
    """

def view_factor_rows(
    scene: CompiledScene,
    rays: int,
    error: float | None,
    seed: int,
    threads: int | None,
    progress: Callable[[float], object] | None,
) -> tuple[
    NDArray[np.float64],
    tuple[NDArray[np.int64], NDArray[np.int32], NDArray[np.float64], NDArray[np.float32]],
    int,
]:
    """Return areas (N,), rows by rays as compressed sparse rows, and the number of rays.

    The rows: where each starts (N+1,), and (K,) faces, view factors and their standard errors.
    """
