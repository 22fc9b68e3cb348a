"""A scene: what can be hit, what shines, and the questions that rays ask of it."""

import threading
import warnings
from collections.abc import Sequence
from os import PathLike
from typing import TYPE_CHECKING, Any, TypeAlias, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from .accelerators import BVH, Accelerator, BruteForce
from .hits import Hits
from .io.meshes import meshes
from .lights import ConstantEnvironment, PointLight
from .mesh import Mesh
from .rays import RayBatch

if TYPE_CHECKING:
    import trimesh

Shapes: TypeAlias = Union[
    Mesh, "trimesh.Trimesh", "trimesh.Scene", str, PathLike[str], "Sequence[Shapes]"
]  # fmt: skip
_BINNED_BVH = BVH()


class Scene:
    """Shapes and lights; compiled for rays the first time that it is asked, and never changed.

    Parameters
    ----------
    shapes : Mesh, trimesh.Trimesh, trimesh.Scene, path, or list or tuple of these
        What can be hit. A path may be of any mesh file that trimesh reads (PLY, OBJ, STL, GLB, ...). Lists
        may be nested; all of it is laid out flat in ``scene.shapes``. A trimesh.Scene gives one mesh for each
        node that holds one, in the order of its geometry and with the node's transform applied; points and
        curves are left out.
    lights : PointLight, or sequence of them
        Lights that are not meshes.
    environment : ConstantEnvironment, float or 3 floats, optional
        What surrounds the scene; numbers are a constant radiance. None is black.
    accelerator : BVH or BruteForce
        The structure that finds hits.

    Raises
    ------
    FileNotFoundError
        If a file is missing.
    ValueError
        If a file is not a mesh that can be read.
    TypeError
        If something is not of the kinds above.

    Notes
    -----
    Faces with a corner that is NaN or infinite are left out when the scene is compiled, with one
    RuntimeWarning that tells how many. Scenes compare by what they hold, and pickle without what was
    compiled.
    """

    def __init__(
        self,
        shapes: Shapes,
        lights: PointLight | Sequence[PointLight] = (),
        environment: ConstantEnvironment | ArrayLike | None = None,
        accelerator: Accelerator = _BINNED_BVH,
    ) -> None:
        self._shapes = meshes(shapes)
        self._lights = tuple(lights) if isinstance(lights, list | tuple) else (lights,)
        for light in self._lights:
            if not isinstance(light, PointLight):
                raise TypeError(f"lights must be raywright lights, got {type(light).__name__}")
        if environment is not None and not isinstance(environment, ConstantEnvironment):
            environment = ConstantEnvironment(environment)
        self._environment = environment
        if not isinstance(accelerator, BVH | BruteForce):
            raise TypeError(f"accelerator must be a BVH or BruteForce, got {type(accelerator).__name__}")
        self._accelerator = accelerator
        self._core: _core.CompiledScene | None = None
        self._lock = threading.Lock()

    @property
    def shapes(self) -> tuple[Mesh, ...]:
        """The meshes; `Hits.shape_id` counts them."""
        return self._shapes

    @property
    def lights(self) -> tuple[PointLight, ...]:
        """The lights that are not meshes."""
        return self._lights

    @property
    def environment(self) -> ConstantEnvironment | None:
        """What surrounds the scene; None is black."""
        return self._environment

    @property
    def accelerator_choice(self) -> Accelerator:
        """The accelerator that was asked for."""
        return self._accelerator

    @property
    def accelerator(self) -> _core.AcceleratorInfo:
        """What the accelerator came to be: kind, nodes, leaves, depth, bytes, build_seconds, sah_cost."""
        return self._compiled().accelerator

    @property
    def bytes(self) -> int:
        """Memory that the compiled scene holds: accelerator, vertices, faces and normals."""
        return self._compiled().bytes

    @property
    def bounds(self) -> NDArray[np.float64] | None:
        """Least and greatest corner of all that can be hit, (2, 3) float64; None for an empty scene."""
        return self._compiled().bounds

    def intersect(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: ArrayLike = 0.0,
        t_max: ArrayLike = np.inf,
        threads: int | None = None,
    ) -> Hits:
        """Find the closest hit of each ray.

        Parameters
        ----------
        origins, directions : (..., 3) arrays
            Rays, broadcast against each other; directions need not be unit. C-contiguous float32 and float64
            are read without a copy, other real types are converted to float64.
        t_min, t_max : float or (...) arrays
            The part of the ray that counts, in lengths of its direction, both ends included.
        threads : int, optional
            How many to use; all cores if not given. The answer does not depend on it.

        Returns
        -------
        Hits
            With the leading shape of the rays. Of hits at the same `t`, the one of the lowest
            (shape_id, primitive).

        Raises
        ------
        ValueError
            If a last dimension is not 3, leading shapes do not broadcast, or `t_min` or `t_max` is NaN.
        TypeError
            If an array does not hold real numbers.

        Notes
        -----
        Rays with NaN, infinity or a zero direction (or one shorter than the least normal number) hit nothing.
        Hits are watertight: no ray passes between two faces that share an edge or a corner.
        """
        rays = RayBatch.of(origins, directions, t_min, t_max, threads)
        compiled = self._compiled()
        t, shape_id, primitive, uv = compiled.intersect(*rays.arguments())
        lead = rays.shape
        return Hits(
            t.reshape(lead), shape_id.reshape(lead), primitive.reshape(lead), uv.reshape(*lead, 2), compiled
        )

    def occluded(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: ArrayLike = 0.0,
        t_max: ArrayLike = np.inf,
        threads: int | None = None,
    ) -> NDArray[np.bool_]:
        """Find whether each ray hits anything between `t_min` and `t_max`.

        The same as ``intersect(...).hit``, and faster: a ray ends at the first hit that it meets. Takes and
        raises what `intersect` does.

        Returns
        -------
        (...) bool
            With the leading shape of the rays.
        """
        rays = RayBatch.of(origins, directions, t_min, t_max, threads)
        found = self._compiled().occluded(*rays.arguments())
        return found.reshape(rays.shape)

    def _compiled(self) -> _core.CompiledScene:
        with self._lock:
            if self._core is not None:
                return self._core
            self._core = compiled = _core.CompiledScene(self, self._accelerator)
        if compiled.dropped:
            faces = sum(len(shape.faces) for shape in self._shapes)
            warnings.warn(
                f"{compiled.dropped} of {faces} faces were dropped: a corner is NaN or infinite",
                RuntimeWarning,
                stacklevel=3,
            )
        return compiled

    def _parts(self) -> tuple[Any, ...]:
        return self._shapes, self._lights, self._environment, self._accelerator

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Scene):
            return NotImplemented
        return self._parts() == other._parts()

    def __hash__(self) -> int:
        return hash(self._parts())

    def __reduce__(self) -> tuple[Any, ...]:
        return Scene, self._parts()

    def __repr__(self) -> str:
        faces = sum(len(shape.faces) for shape in self._shapes)
        parts = [f"{_counted(len(self._shapes), 'shape')}", _counted(faces, "face")]
        if self._lights:
            parts.append(_counted(len(self._lights), "light"))
        if self._environment is not None:
            parts.append(repr(self._environment))
        return f"Scene({', '.join(parts)}, {self._accelerator!r})"


def _counted(count: int, name: str) -> str:
    return f"{count} {name}{'' if count == 1 else 's'}"
