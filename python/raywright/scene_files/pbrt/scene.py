"""A whole scene."""

from __future__ import annotations

import errno
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ...integrators import AmbientOcclusion, AnyIntegrator
from ...integrators import Path as PathTraced
from ...lights import Environment, Light
from ...materials import Diffuse, Material
from ...rendering.filters import Filter, GaussianFilter
from ...rendering.render_setup import RenderSetup
from ...rendering.samplers import Sampler, Sobol
from ...scene.instance import Instance
from ...scene.scene import Scene
from ..mitsuba.transforms import rotation
from ..notes import Notes
from . import lights, shapes, views
from .errors import PbrtError
from .films import Film, exposure, film
from .materials import Materials
from .parameters import Floats, Given, Parameters
from .textures import Textures
from .tokens import Directive, directives, text_of
from .versions import older

_MOST_FILES, _MOST_DEPTH = 1000, 32
# Kinds of objects that attributes apply to.
_TARGETS = ("shape", "light", "material", "medium", "texture")
# Options without effect on a picture here.
_NEUTRAL = ("pixelstats", "wavefront", "rendercoordsys", "msereferenceimage", "msereferenceout", "seed")
# Mirrors a left-handed world; a world that the file mirrored already stays.
_MIRROR, _AS_IT_IS = np.diag([-1.0, 1.0, 1.0, 1.0]), np.eye(4)


def read_pbrt(path: Path) -> RenderSetup:
    """Read a scene in the format of pbrt, version 4.

    Parameters
    ----------
    path : Path
        The file; what it names is looked for in its folder.

    Raises
    ------
    FileNotFoundError
        If a file is missing.
    ValueError
        If something is not supported, or is not as it must be; the error gives the line.

    Warns
    -----
    RuntimeWarning
        Once of each kind of thing in the file that is approximated or left out.
    """
    reader = _Reader(path)
    try:
        reader.file(path, 0)
        shot = reader.shot()
    except PbrtError as error:
        if (version := reader.version()) is None:
            raise
        raise PbrtError(f"{error}; {version}") from error
    reader.notes.warn()
    return shot


class _Later(NamedTuple):
    """A material that is named before it is made."""

    name: str
    parameters: Parameters


@dataclass(frozen=True)
class _State:
    """State of the graphics, changed by directives and kept by attributes."""

    matrix: Floats = field(default_factory=lambda: np.eye(4))
    material: Material | _Later = field(default_factory=Diffuse)
    emission: Any = None
    flipped: bool = False
    # True if transforms apply at the time when the shutter opens.
    starts: bool = True
    defaults: tuple[tuple[str, Given], ...] = ()


class _Reader:
    """A scene, as far as it is read."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.notes = Notes(path)
        self._state = _State()
        self._kept: list[_State] = []
        self._named: dict[str, Floats] = {}
        self._textures = Textures(path.parent)
        self._materials = Materials(self._textures, self.notes)
        self._groups: dict[str, list[Any]] = {}
        self._group: str | None = None
        self._found: list[Any] = []
        self._lights: list[Light] = []
        self._around: list[Environment] = []
        self._files: list[Path] = []
        self._in_world = False
        self._camera: tuple[str, Parameters, Floats] | None = None
        self._mirror = _MIRROR
        self._film = Film()
        self._imaging: Floats = np.eye(3)
        self._filter: Filter = GaussianFilter(1.5, 0.5)
        self._sampler: tuple[Sampler | None, int, int] = (Sobol(), 16, 0)
        self._integrator: AnyIntegrator = PathTraced(5)
        # Materials referenced before their definition, and shapes that wait for one: their place and
        # constructor.
        self._awaited: list[_Later] = []
        self._later: list[tuple[list[Any], int, Callable[[Material], Any], _Later]] = []
        # Cameras, films and the like are made once all of their options are known.
        self._instances: list[tuple[str, Floats, Parameters]] = []

    def file(self, path: Path, depth: int) -> None:
        """Read a file, and those that it includes."""
        self._files.append(path)
        if depth > _MOST_DEPTH or len(self._files) > _MOST_FILES:
            raise PbrtError(f"{path}: files include each other recursively")
        if not path.exists():
            raise FileNotFoundError(errno.ENOENT, "no such file", str(path))
        for one in directives(path, self.notes):
            if one.name in ("Include", "Import"):
                self.file(self.path.parent / one.texts[0], depth + 1)
            else:
                self._read(one)

    def version(self) -> str | None:
        """Return what says that the files read so far are those of another version of pbrt."""
        for path in self._files:
            if path.exists() and (found := older(text_of(path))) is not None:
                return f"{path} is a file of {found}: pbrt-v4 makes one of its own of it by pbrt --upgrade"
        return None

    def _read(self, one: Directive) -> None:
        """Run a directive; errors name its line."""
        try:
            self._directive(one)
        except PbrtError:
            raise
        except (ValueError, TypeError) as error:
            one.parameters.fail(str(error))

    def _directive(self, one: Directive) -> None:
        name = one.name
        if name in ("LookAt", "Translate", "Scale", "Rotate", "Transform", "ConcatTransform", "Identity"):
            if not self._state.starts:
                return
            before = np.eye(4) if name in ("Transform", "Identity") else self._state.matrix
            self._set(matrix=before @ _step(one))
        elif name in ("AttributeBegin", "TransformBegin"):
            self._kept.append(self._state)
        elif name in ("AttributeEnd", "TransformEnd"):
            self._restore(one, only_matrix=name == "TransformEnd")
        elif name == "CoordinateSystem":
            self._named[one.texts[0]] = self._state.matrix
        elif name == "CoordSysTransform":
            if one.texts[0] not in self._named:
                raise PbrtError(f"{one.where}: there is no coordinate system {one.texts[0]!r}")
            self._set(matrix=self._named[one.texts[0]])
        elif name == "ReverseOrientation":
            self._set(flipped=not self._state.flipped)
        elif name == "Attribute":
            if one.texts[0] not in _TARGETS:
                one.parameters.fail(f"its target must be one of {', '.join(_TARGETS)}")
            self._set(defaults=(*self._state.defaults, (one.texts[0], one.parameters.given)))
        elif name == "WorldBegin":
            self._in_world = True
            self._set(matrix=np.eye(4), starts=True)
            self._imaging = self._film.imaging(1.0 if self._camera is None else exposure(self._camera[1]))
        elif name == "ActiveTransform":
            self.notes.tell("motion is left out: objects stay where they are when the shutter opens")
            self._set(starts=one.texts[0] != "EndTime")
        elif name == "Option":
            one.parameters.ignore(*_NEUTRAL)
            one.parameters.leave_out(*one.parameters.given)
        elif name in ("Accelerator", "TransformTimes"):
            pass
        elif name == "ColorSpace":
            if one.texts[0] != "srgb":
                raise PbrtError(f"{one.where}: a color space must be srgb")
        elif name in ("MakeNamedMedium", "MediumInterface"):
            if name == "MakeNamedMedium" or any(one.texts):
                raise PbrtError(f"{one.where}: {name} is not supported, as media are not")
        elif name in ("Camera", "Film", "PixelFilter", "Sampler", "Integrator"):
            self._option(one)
        else:
            self._part(one)

    def _option(self, one: Directive) -> None:
        (kind,), parameters = one.texts, one.parameters
        if one.name == "Camera":
            self._named["camera"] = np.asarray(np.linalg.inv(self._state.matrix), np.float64)
            self._camera = kind, parameters, self._named["camera"]
            # The camera's +x is to the right, so that the world is left-handed unless mirrored.
            self._mirror = _MIRROR if np.linalg.det(self._state.matrix[:3, :3]) > 0 else _AS_IT_IS
        elif one.name == "Film":
            self._film = film(kind, parameters)
        elif one.name == "PixelFilter":
            self._filter = views.rfilter(kind, parameters)
        elif one.name == "Sampler":
            self._sampler = views.sampler(kind, parameters)
        else:
            self._integrator = views.integrator(kind, parameters)

    def _part(self, one: Directive) -> None:
        state, texts, parameters = self._state, one.texts, one.parameters
        if one.name == "Texture":
            name, of, kind = texts
            self._textures.add(name, of, kind, parameters.over(self._defaults("texture")))
        elif one.name == "Material":
            self._set(
                material=self._materials.material(texts[0], parameters.over(self._defaults("material")))
            )
        elif one.name == "MakeNamedMaterial":
            self._materials.add(texts[0], parameters.over(self._defaults("material")))
        elif one.name == "NamedMaterial":
            (name,) = texts
            if self._materials.has(name):
                self._set(material=self._materials.named(name, parameters))
            else:
                self._awaited.append(_Later(name, parameters))
                self._set(material=self._awaited[-1])
        elif one.name == "AreaLightSource":
            if texts[0] != "diffuse":
                parameters.fail(f"an area light {texts[0]!r} is not supported")
            self._set(emission=shapes.emission(parameters.over(self._defaults("light")), self._imaging))
        elif one.name == "LightSource":
            made = lights.light(
                texts[0],
                parameters.over(self._defaults("light")),
                self._mirror @ state.matrix,
                self._textures,
                self._imaging,
            )
            if isinstance(made, Light):
                self._lights.append(made)
            else:
                self._around.append(made)
        elif one.name == "Shape":
            self._shape(texts[0], parameters.over(self._defaults("shape")))
        elif one.name == "ObjectBegin":
            if self._group is not None:
                raise PbrtError(f"{one.where}: objects cannot be nested")
            self._kept.append(state)
            self._group = texts[0]
            self._groups[texts[0]] = []
        elif one.name == "ObjectEnd":
            if self._group is None:
                raise PbrtError(f"{one.where}: ObjectEnd without ObjectBegin")
            self._group = None
            self._restore(one)
        else:
            self._instances.append((texts[0], self._mirror @ state.matrix, parameters))

    def _shape(self, kind: str, parameters: Parameters) -> None:
        state = self._state
        in_group = self._group is not None
        if in_group and state.emission is not None:
            self.notes.tell("area lights in objects are left out, as pbrt leaves them out")
        # The mirrored world applies to the group as a whole.
        matrix = state.matrix if in_group else self._mirror @ state.matrix

        def made(material: Material) -> Any:
            look = shapes.Look(material, None if in_group else state.emission, state.flipped)
            return shapes.shape(kind, parameters, matrix, look, self._textures)

        target = self._found if self._group is None else self._groups[self._group]
        if isinstance(state.material, _Later):
            self._later.append((target, len(target), made, state.material))
            target.append(None)
        else:
            target.append(made(state.material))

    def _defaults(self, target: str) -> Given:
        found: dict[str, tuple[str, list[Any]]] = {}
        for name, given in self._state.defaults:
            if name == target:
                found.update(given)
        return found

    def _set(self, **changes: Any) -> None:
        self._state = replace(self._state, **changes)

    def _restore(self, one: Directive, only_matrix: bool = False) -> None:
        if not self._kept:
            raise PbrtError(f"{one.where}: {one.name} without its begin")
        before = self._kept.pop()
        self._state = replace(self._state, matrix=before.matrix) if only_matrix else before

    def shot(self) -> RenderSetup:
        """Return what has been read."""
        if not self._in_world:
            raise PbrtError(f"{self.path} has no WorldBegin")
        if self._camera is None:
            raise PbrtError(f"{self.path} has no Camera")
        if self._kept or self._group is not None:
            raise PbrtError(f"{self.path} ends within an attribute or an object")
        for awaited in self._awaited:
            self._materials.named(*awaited)
        for target, place, made, awaited in self._later:
            target[place] = made(self._materials.named(*awaited))
        places: dict[str, list[Floats]] = {}
        for name, matrix, parameters in self._instances:
            if name not in self._groups:
                parameters.fail(f"there is no object {name!r}")
            if self._groups[name]:
                places.setdefault(name, []).append(matrix)
        found = self._found + [
            Instance(self._groups[name], np.stack(where)) for name, where in places.items()
        ]
        kind, parameters, matrix = self._camera
        if isinstance(self._integrator, AmbientOcclusion) and not np.array_equal(self._imaging, np.eye(3)):
            self.notes.tell("the film's exposure does not count in ambient occlusion")
        sampler, samples, seed = self._sampler
        around = self._around[0] if len(self._around) == 1 else self._around or None
        try:
            eye = views.camera(kind, parameters, self._mirror @ matrix, self._film.size)
        except PbrtError:
            raise
        except (ValueError, TypeError) as error:
            parameters.fail(str(error))
        return RenderSetup(
            Scene(found, self._lights, around),
            eye,
            self._integrator,
            samples,
            sampler=sampler,
            filter=self._filter,
            seed=seed,
            clamp=self._film.most,
        )


def _step(one: Directive) -> Floats:
    """Return the matrix of a directive, which is applied before the ones before it."""
    values = np.array(one.numbers)
    if not np.isfinite(values).all():
        raise PbrtError(f"{one.where}: {one.name} must be finite numbers")
    if one.name in ("Transform", "ConcatTransform"):
        matrix = values.reshape(4, 4).T
        if not np.array_equal(matrix[3], (0, 0, 0, 1)):
            raise PbrtError(f"{one.where}: {one.name} must be affine")
        return matrix
    matrix = np.eye(4)
    if one.name == "Translate":
        matrix[:3, 3] = values
    elif one.name == "Scale":
        if not values.all():
            raise PbrtError(f"{one.where}: Scale must not be 0")
        matrix[:3, :3] = np.diag(values)
    elif one.name == "Rotate":
        if not values[1:].any():
            raise PbrtError(f"{one.where}: Rotate must have an axis")
        matrix[:3, :3] = rotation(values[1:], values[0])
    elif one.name == "LookAt":
        eye, target, up = values[:3], values[3:6], values[6:]
        forward = target - eye
        right = np.cross(up, forward)
        if not np.linalg.norm(right) > 0:
            raise PbrtError(f"{one.where}: LookAt must have an up that is not parallel to the view")
        forward, right = forward / np.linalg.norm(forward), right / np.linalg.norm(right)
        placed = np.eye(4)
        placed[:3] = np.column_stack([right, np.cross(forward, right), forward, eye])
        matrix = np.linalg.inv(placed)
    return np.asarray(matrix, np.float64)
