"""The scene: shapes, lights, environment and medium."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import AbstractContextManager
from typing import Any, Literal, Protocol, TypeAlias, TypeVar, get_args

from numpy.typing import ArrayLike

from .. import _core
from ..accelerators import BVH, Accelerator
from ..arrays import choice
from ..lights import Environment, Light, environments
from ..lights import lights as checked_lights
from ..media.medium import Medium
from ..media.medium import medium as checked_medium
from ..query.masks import names_of
from ..shapes.mesh import has_noise
from ..shapes.welding import Weld, weld_tolerance
from .built_once import BuiltOnce
from .instance import AnyShape, Shapes, closed, meshes
from .moved_shapes import moved_shapes
from .plan import Plan, PlanRow
from .shown import scene_html, scene_repr
from .wavelengths import reason

Precision: TypeAlias = Literal["auto", "single", "double"]
Quality: TypeAlias = Literal["low", "medium", "high"]
ShadingNormals: TypeAlias = Literal["faded", "raw"]
Held = TypeVar("Held", covariant=True)
_BINNED_BVH = BVH()
_ARGUMENTS = (
    "shapes",
    "lights",
    "environment",
    "accelerator",
    "precision",
    "quality",
    "medium",
    "shading_normals",
    "weld",
)


class Device(Protocol[Held]):
    """A device that holds a scene: a `Gpu`."""

    def upload(self, scene: Scene) -> AbstractContextManager[Held]:
        """Hold a scene during a ``with`` block."""


class Scene(BuiltOnce):
    """Shapes, lights and media; the first query compiles them for rays.

    A scene is immutable, except that `refit` moves its vertices. Many threads may query it at once. Large
    scenes take a while to compile: `build` does so ahead of the first query, and shows its progress.

    Parameters
    ----------
    shapes : Mesh, another shape, Instance, path, object of another library, or list or dict of these
        Shapes that rays can hit. A path may be of a PLY, OBJ, STL, OFF or glTF file, or any other that
        trimesh reads. Objects are meshes and scenes of trimesh, data sets of pyvista and VTK, meshes of
        Open3D, meshio, manifold3d and Blender, shapes of CadQuery and build123d, and ``(vertices, faces)``
        pairs of arrays or tensors; see `Mesh.of`. Lists and dicts may be nested; ``scene.shapes`` is the
        flattened list, and keys of dicts are the names. A trimesh.Scene becomes one mesh for each node with a
        mesh, in the order of its geometry and with the node's transform applied. Points and curves are left
        out, with a warning.
    lights : PointLight, SpotLight, DirectionalLight or ProjectorLight, or sequence of them
        Lights without a surface.
    environment : ConstantEnvironment, EnvironmentMap, SunSky, list of these, float or 3 floats, optional
        Light from infinity; numbers are a constant radiance, and several environments add up. None is black.
    accelerator : BVH, KdTree, Octree, BSP, Grid, NestedGrid or BruteForce
        The accelerator.
    precision : {"auto", "single", "double"}
        Precision of vertices: "single" rounds them to float32, which takes the least memory and is the
        fastest, "double" does not round. "auto" loses no digit: vertices are float32 if all of them are
        float32 numbers, as those of most binary files are, and float64 otherwise. Either way hits are exact
        for the stored vertices. "double" costs nothing if all vertices are float32 numbers anyway.
    quality : {"medium", "low", "high"}
        Effort of the accelerator's build for faster rays. "medium" and "high" use oriented bounding boxes if
        the geometry is rotated as a whole, and may split long diagonal primitives: by spatial splits if they
        are few, before the build if they are many. "high" splits more of them. `refit` rebuilds a tree with
        split primitives.

    medium : Homogeneous or GridMedium, optional
        Medium outside of all shapes: haze, fog, sea. None is clear.
    shading_normals : {"faded", "raw"}
        Treatment of shading normals: those of vertices, bump maps and normal maps. "faded" lets light fade
        towards the horizon of the face, so that facets are invisible at grazing angles, and bends normals
        towards a viewer that they face away from. "raw" does neither, as in other renderers: see Notes.
    weld : "auto", float or None
        Maximum distance of corners to merge, in the scene's unit: see Notes. None merges equal corners only.

    Raises
    ------
    FileNotFoundError
        If a file is missing.
    ValueError
        If a file is not a mesh that can be read, `precision`, `quality` or `shading_normals` is not one
        of those, or `weld` is negative or not finite.
    TypeError
        If an argument has another type.

    See Also
    --------
    load : Load a scene file of another renderer.
    render : Render a picture of a scene.
    Instance : Copies of shapes within a scene.

    Notes
    -----
    With "auto", only vertices that faces use count. If one mesh needs float64, all meshes of the scene are
    kept in float64, so that shared vertices stay equal; the shapes of an `Instance` are a separate group.
    `plan` reports the displacement by rounding, and ``accelerator_info.precision`` the precision in use. If
    "single" moves a vertex by more than 1e-7 of the extent of its mesh, there is one RuntimeWarning, with the
    figure, when the scene is compiled.

    With "raw", light is weighted by its cosine to the shading normal alone, which also decides the visible
    side: a `TwoSided` whose shading normal points away from the viewer shows its back. Light on one side of a
    face still does not reach the other. Under bump and normal maps, light is shadowed by the unperturbed
    normal (Estevez, Lecocq and Stein, "A Microfacet-Based Shadowing Function to Solve the Bump Terminator
    Problem", 2019); a normal that faces away from the viewer is rotated by 180° about the unperturbed one;
    and of a `BumpMap` only slopes count. Mitsuba does all this. Scenes without shading normals do not change;
    in others, paths are slower, ``Path(reuse=)`` shares nothing at such surfaces, and a `Gpu` leaves the
    picture to the CPU.

    Corners that differ by rounding leave cracks, through which rays slip, and surfaces that do not close. So
    corners on open edges are merged within the distance `weld`: "auto" is 2^-21 of the largest coordinate of
    a mesh if all are float32 numbers, 2^-47 if not, and a 64th of its mean edge at most, before transforms;
    between two meshes the lesser one applies. Two corners of one face are never merged, and closed meshes
    stay unchanged, even if thin. "auto" welds each file, trimesh object and CAD shape by itself; a `Mesh` of
    arrays, or an object of another library, is welded only for `contains`, `signed_distance` and
    ``rw.measure``, and its hits are those of the given vertices. A given distance welds all meshes together;
    those of an `Instance` are a separate group. ``rw.measure.topology`` lists the remaining cracks.

    Faces with a corner that is NaN or infinite are left out when the scene is compiled, with one
    RuntimeWarning that gives their number. Scenes compare by contents, and pickle without compiled data. A
    process caches the last two unpickled scenes that it compiled, so each process of a pool compiles the
    scene of its tasks once.

    Examples
    --------
    >>> scene = rw.Scene({"ball": rw.Sphere(radius=0.5), "floor": rw.Plane((0, 0, -1), (0, 0, 1))})
    >>> scene.names
    ('ball', 'floor')
    >>> hits = scene.intersect([[0, 0, 3], [2, 0, 3]], [0, 0, -1])
    >>> hits.t.tolist(), hits.names.tolist()
    ([2.5, 4.0], ['ball', 'floor'])
    """

    def __init__(
        self,
        shapes: Shapes,
        lights: Light | Sequence[Light] = (),
        environment: Environment | Sequence[Environment] | ArrayLike | None = None,
        accelerator: Accelerator = _BINNED_BVH,
        precision: Precision = "auto",
        quality: Quality = "medium",
        medium: Medium | None = None,
        shading_normals: ShadingNormals = "faded",
        weld: Weld = "auto",
    ) -> None:
        super().__init__()
        self._weld, self._tolerance = weld, weld_tolerance(weld)
        self._shapes = meshes(shapes, weld)
        self._has_noise = any(map(has_noise, self._shapes))
        self._lights = checked_lights(lights)
        self._environment = environments(environment)
        if not isinstance(accelerator, Accelerator):
            kinds = ", ".join(kind.__name__ for kind in get_args(Accelerator))
            raise TypeError(f"accelerator must be one of {kinds}, got {type(accelerator).__name__}")
        self._accelerator = accelerator
        choice("precision", precision, get_args(Precision))
        choice("quality", quality, get_args(Quality))
        choice("shading_normals", shading_normals, get_args(ShadingNormals))
        self._precision, self._quality = precision, quality
        self._shading_normals = shading_normals
        self._medium = checked_medium("medium", medium)
        surroundings = self._environment if isinstance(self._environment, tuple) else (self._environment,)
        self._wavelengths = reason(self._shapes, (*self._lights, *surroundings, self._medium))
        # The same shapes with corners welded, for measurements.
        self._closed: tuple[tuple[AnyShape, ...], Scene] | None = None

    @property
    def shapes(self) -> tuple[AnyShape, ...]:
        """Shapes that rays can hit; `Hits.shape_id` is an index of it."""
        return self._shapes

    @property
    def names(self) -> tuple[str, ...]:
        """Name of each shape, "" if it has none."""
        return names_of(self._shapes)

    @property
    def lights(self) -> tuple[Light, ...]:
        """The lights without a surface."""
        return self._lights

    @property
    def environment(self) -> Environment | tuple[Environment, ...] | None:
        """The environment, a tuple if there are several; None is black."""
        return self._environment

    @property
    def accelerator(self) -> Accelerator:
        """The argument `accelerator`."""
        return self._accelerator

    @property
    def precision(self) -> Precision:
        """The argument `precision`: "auto", "single" or "double"."""
        return self._precision

    @property
    def quality(self) -> Quality:
        """The argument `quality`: "low", "medium" or "high"."""
        return self._quality

    @property
    def medium(self) -> Medium | None:
        """Medium outside of all shapes; None is clear."""
        return self._medium

    @property
    def shading_normals(self) -> ShadingNormals:
        """The argument `shading_normals`: "faded" or "raw"."""
        return self._shading_normals

    @property
    def weld(self) -> Weld:
        """The argument `weld`: "auto", a distance, or None to merge equal corners only."""
        return self._weld

    @property
    def wavelengths(self) -> str | None:
        """The reason for spectral rendering; None if the scene is rendered in red, green and blue."""
        return self._wavelengths

    def replace(self, **changes: Any) -> Scene:
        """Return a copy of the scene with some arguments changed.

        The first query compiles it: if only lights, environment or medium differ, it shares this one's
        accelerator. ``copy.replace`` (Python 3.13) does the same.

        Parameters
        ----------
        **changes
            Arguments of `Scene`, by name.

        Returns
        -------
        Scene

        Raises
        ------
        TypeError
            If `Scene` has no such argument; also as raised by `Scene`.
        ValueError, FileNotFoundError
            As `Scene` does.

        See Also
        --------
        Scene.refit : Move the vertices of a scene in place.

        Examples
        --------
        >>> scene = rw.Scene(rw.Sphere(), environment=1.0)
        >>> brighter = scene.replace(environment=2.0)
        >>> brighter.shapes == scene.shapes, brighter == scene
        (True, False)
        """
        for name in changes:
            if name not in _ARGUMENTS:
                raise TypeError(f"a Scene has no {name!r} to replace; it has {', '.join(_ARGUMENTS)}")
        scene = Scene(**{**dict(zip(_ARGUMENTS, self._parts(), strict=True)), **changes})
        if changes.keys() <= {"lights", "environment", "medium"}:
            scene._alike = self._core or self._alike
        return scene

    __replace__ = replace

    def refit(self, vertices: ArrayLike | Sequence[ArrayLike | None]) -> float:
        """Move the vertices and refit the accelerator, much faster than building a new scene.

        Faces, materials, lights and given normals stay as they are. ``scene.shapes`` are new meshes; earlier
        hits keep their values.

        Parameters
        ----------
        vertices : (V, 3) array, or list of them
            New vertices of the only shape, or of each shape, of equal number. None in the list leaves a shape
            in place; curved shapes must have None. An `Instance` takes transforms, (4, 4) or (N, 4, 4), or a
            tuple of two such arrays for copies that move; its shapes stay as they are.

        Returns
        -------
        float
            Ratio of the accelerator's expected cost (`sah_cost`) to that after its last build: at 1 it is as
            good as new, at 2 rays take about twice as long, and `rebuild` helps.

        Raises
        ------
        ValueError
            If the number of meshes or of vertices is another.
        TypeError
            If an array does not hold real numbers.

        See Also
        --------
        Scene.rebuild : Build the accelerator anew after large motions.
        Scene.replace : Return a new scene with some arguments changed.

        Notes
        -----
        The accelerator is rebuilt if it cannot be refitted, for example if other faces than before have a
        corner that is NaN or infinite, or if faces were split; ``scene.accelerator_info.kind`` then does not
        end in "refitted". With ``quality="low"`` the default accelerator splits no faces. A scene that is not
        compiled yet is built by its first query.

        Examples
        --------
        >>> triangle = rw.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
        >>> scene = rw.Scene(triangle)
        >>> scene.intersect([0.2, 0.2, 5], [0, 0, -1]).t.item()
        5.0
        >>> growth = scene.refit(triangle.vertices + [0, 0, 2])
        >>> scene.intersect([0.2, 0.2, 5], [0, 0, -1]).t.item()
        3.0
        """
        after = Scene(moved_shapes(self._shapes, vertices), *self._parts()[1:])
        with self._unless_building():
            core = self._core and self._core.refitted(after)
            built, self._shapes, self._core = self._core is not None, after.shapes, core
            self._alike = None
        if core is None and built:
            core = self._compiled()
        elif core is not None:
            self._tell_loss(core)
        return core.growth if core else 1.0

    def welded(self) -> Scene:
        """Return the scene with its meshes welded: corners that differ by rounding are merged, by `weld`.

        Returns
        -------
        Scene
            The scene itself if no corner moves, as for files and closed meshes.

        See Also
        --------
        measure.topology : Report the cracks that remain.

        Examples
        --------
        >>> left = rw.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
        >>> right = rw.Mesh([[1, 1, 0], [0, 1, 1e-9], [1, 0, 0]], [[0, 1, 2]])
        >>> welded = rw.Scene([left, right], weld=1e-6).welded()
        >>> bool(np.isin(welded.shapes[1].vertices[1], welded.shapes[0].vertices).all())
        True
        """
        if self._closed is None or self._closed[0] is not self._shapes:
            shapes = closed(self._shapes, self._weld)
            is_same = all(a is b for a, b in zip(shapes, self._shapes, strict=True))
            self._closed = self._shapes, self if is_same else Scene(shapes, *self._parts()[1:])
        return self._closed[1]

    def _enclosing(self) -> _core.CompiledScene:
        # The compiled scene does not know the precision of vertices before a transform.
        scene = self.welded() if self._has_noise and self._tolerance is None else self
        return scene._core or scene._compiled()

    def plan(self) -> Plan:
        """Return a table of the features that the scene needs or leaves out, and the kernel that renders it.

        One row has the precision of vertices, and their displacement by rounding.

        Returns
        -------
        Plan
            A row for each feature.

        See Also
        --------
        rendering.RenderPlan : Options that a render has chosen.

        Examples
        --------
        >>> scene = rw.Scene(rw.Sphere(material=rw.Mirror()), environment=1.0)
        >>> plan = scene.plan()
        >>> plan.needed[:2]
        ('light', 'materials')
        """
        return Plan(tuple(PlanRow(*row) for row in _core.plan(self._compiled())))

    def on_device(self, device: Device[Held]) -> AbstractContextManager[Held]:
        """Copy the scene to a device, which then answers ray queries.

        Parameters
        ----------
        device : Gpu
            The device.

        Returns
        -------
        GpuScene
            For use in a ``with`` block, whose end frees the memory of the device.

        Raises
        ------
        TypeError
            If `device` is no `Gpu`.

        See Also
        --------
        Gpu : A graphics processor.
        Scene.gpu_arrays : The arrays that are copied.

        Examples
        --------
        >>> scene = rw.Scene(rw.Sphere())
        >>> try:
        ...     scene.on_device("a device")
        ... except TypeError as error:
        ...     print(error)
        device must be a Gpu, got 'a device'
        """
        if isinstance(device, type) or not hasattr(device, "upload"):
            raise TypeError(f"device must be a Gpu, got {device!r}")
        return device.upload(self)

    def _parts(self) -> tuple[Any, ...]:
        """Return the arguments of the scene, in their order."""
        return (
            self._shapes,
            self._lights,
            self._environment,
            self._accelerator,
            self._precision,
            self._quality,
            self._medium,
            self._shading_normals,
            self._weld,
        )

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Scene):
            return NotImplemented
        return self._parts() == other._parts()

    def __hash__(self) -> int:
        return hash(self._parts())

    def __reduce__(self) -> tuple[Any, ...]:
        return _arrived, self._parts()

    def __copy__(self) -> Scene:
        return Scene(*self._parts())

    def __deepcopy__(self, memo: dict[int, Any]) -> Scene:
        # A scene is immutable, so copies share all parts.
        return Scene(*self._parts())

    def _repr_html_(self) -> str:
        return scene_html(self)

    def __repr__(self) -> str:
        return scene_repr(self)


def _arrived(*parts: Any) -> Scene:
    scene = Scene(*parts)
    scene._has_arrived = True
    return scene


SceneLike: TypeAlias = Scene | Shapes


def as_scene(scene: SceneLike) -> Scene:
    """Return the scene, or the one of some shapes."""
    return scene if isinstance(scene, Scene) else Scene(scene)
