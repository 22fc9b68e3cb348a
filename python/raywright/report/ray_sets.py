"""Typical rays for comparisons of accelerators: primary, diffuse and shadow rays of a camera."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import SeedLike, last_axis, seed_number
from ..cameras import AnyCamera, Camera
from ..query.rays import ray_arguments
from ..scene.scene import Scene
from ..shapes.mesh import Mesh

# Default view: from three quarters, above, and so far away (in radii) that the whole bounding sphere is in
# view, i.e. more than 1 over the sine of half the angle.
_AWAY = np.array([0.45, 0.5, 0.74])
_DISTANCE = 2.4
_FOV = 50.0
# Offset of ray origins from the surface, relative to the greatest coordinate: a million times the rounding
# error.
_LIFT = 1e-9
# Shadow rays end just before the lamp, which may be a surface itself.
_BEFORE_LAMP = 1 - 1e-4


@dataclass(frozen=True, eq=False)
class Rays:
    """Rays of one kind, and their query.

    Parameters
    ----------
    origins, directions : (..., 3) arrays
        Broadcast against each other; rays of two leading dimensions are an image.
    t_max : float
        Length of the rays, in lengths of their directions.
    any_hit : bool
        True for occlusion queries (`Scene.occluded`), False for closest hits.

    Raises
    ------
    ValueError, TypeError
        As `Scene.intersect`; ValueError too if there is no ray.

    See Also
    --------
    report.typical_rays : Sets of rays.

    Examples
    --------
    >>> rays = rw.report.Rays(np.zeros((4, 3)), [0, 0, 1], any_hit=True)
    >>> rays.count, rays.any_hit
    (4, True)
    """

    origins: NDArray[np.floating[Any]]
    directions: NDArray[np.floating[Any]]
    t_max: float = np.inf
    any_hit: bool = False

    def __post_init__(self) -> None:
        shape = ray_arguments(self.origins, self.directions, 0.0, float(self.t_max), None)[4]
        for name in ("origins", "directions"):
            array = np.broadcast_to(last_axis(name, getattr(self, name), 3), (*shape, 3))
            object.__setattr__(self, name, np.ascontiguousarray(array))
        if not self.count:
            raise ValueError("rays must not be empty")

    @property
    def count(self) -> int:
        """Number of rays."""
        return self.origins.size // 3

    def thinned(self, max_rays: int) -> Rays:
        """Return at most `max_rays` of the rays, evenly spread; an image stays an image.

        Parameters
        ----------
        max_rays : int
            Maximum number of rays.

        Returns
        -------
        Rays

        Examples
        --------
        >>> rw.report.Rays(np.zeros((100, 3)), [0, 0, 1]).thinned(10).count
        10
        """
        if self.count <= max_rays:
            return self
        lead = self.origins.shape[:-1]
        if len(lead) == 2 and min(lead) ** 2 > self.count / max_rays:
            step = int(np.ceil((self.count / max_rays) ** 0.5))
            while -(-lead[0] // step) * -(-lead[1] // step) > max_rays:
                step += 1
            origins, directions = (a[::step, ::step] for a in (self.origins, self.directions))
        else:
            chosen = np.linspace(0, self.count - 1, max(max_rays, 1)).astype(np.int64)
            origins, directions = (a.reshape(-1, 3)[chosen] for a in (self.origins, self.directions))
        return replace(self, origins=origins, directions=directions)


def typical_rays(scene: Scene, camera: AnyCamera | None = None, seed: SeedLike = 0) -> dict[str, Rays]:
    """Return the typical rays of a renderer: primary, diffuse and shadow.

    Parameters
    ----------
    scene : Scene
        The scene that they are traced in.
    camera : Camera or another kind, optional
        Camera of the primary rays, one through the center of each pixel. If not given, a camera outside with
        all of the scene in view, of 256 by 256 pixels.
    seed : int, Generator or SeedSequence
        Seed of the directions of diffuse rays.

    Returns
    -------
    dict of Rays
        ``"primary"``, an image. ``"diffuse"``, one from each visible point, in the order of pixels,
        cosine-weighted about the normal on the side of the camera. ``"shadow"``, one any-hit ray from each
        such point to a lamp: to the scene's point lights in turn; or to points on its emissive meshes,
        uniform in area; or, without lights, to a lamp above the camera's right shoulder.

    Raises
    ------
    ValueError
        If the scene is empty, or no primary ray hits anything.

    See Also
    --------
    report.accelerators : Times them.

    Examples
    --------
    >>> scene = rw.Scene(rw.scenes.torus_knot(along=40, around=8))
    >>> camera = rw.Camera((0, 0, 9), (0, 0, 0), width=8, height=8)
    >>> rays = rw.report.typical_rays(scene, camera)
    >>> list(rays), rays["primary"].count
    (['primary', 'diffuse', 'shadow'], 64)
    """
    seed = seed_number(seed)
    camera = camera or outside(scene)
    eye, towards = camera.rays()
    hits = scene.intersect(eye, towards)
    if not hits.hit.any():
        raise ValueError("no primary ray hits anything: aim the camera at the scene")
    rng = np.random.default_rng(seed)
    normal = hits.normal[hits.hit]
    normal *= np.where(np.sum(normal * towards[hits.hit], axis=1, keepdims=True) > 0, -1.0, 1.0)
    points = hits.position[hits.hit]
    points = points + _LIFT * np.abs(points).max() * normal
    # A point of the unit sphere that touches the surface, seen from the point of contact (Lambert's law).
    bounced = normal + _units(rng.normal(size=normal.shape))
    lamps = _lamps(scene, camera, float(np.median(hits.t[hits.hit])), len(points), rng)
    return {
        "primary": Rays(eye, towards),
        "diffuse": Rays(points, bounced),
        "shadow": Rays(points, lamps - points, _BEFORE_LAMP, any_hit=True),
    }


def ray_sets(scene: Scene, rays: Any, seed: int) -> dict[str, Rays]:
    """Return sets of rays by name, from the argument of a report.

    None and a Camera are `typical_rays`; a Rays and a pair (origins, directions) are the only set; a dict has
    a name for each.

    Raises
    ------
    ValueError, TypeError
        As `typical_rays` and `Rays`; TypeError too if it is none of these.
    """
    if rays is None or isinstance(rays, AnyCamera):
        return typical_rays(scene, rays, seed)
    if not isinstance(rays, Mapping):
        return {"rays": _one("rays", rays)}
    if not rays:
        raise ValueError("rays must not be empty")
    return {str(name): _one(f"rays[{name!r}]", one) for name, one in rays.items()}


def _one(name: str, rays: Any) -> Rays:
    if isinstance(rays, Rays):
        return rays
    if isinstance(rays, tuple | list) and len(rays) == 2:
        return Rays(*rays)
    raise TypeError(f"{name} must be a Camera, Rays, or (origins, directions), got {type(rays).__name__}")


def outside(scene: Scene, side: int = 256) -> Camera:
    """Return a camera of `side` by `side` pixels that sees all of a scene from outside.

    Raises
    ------
    ValueError
        If the scene is empty.
    """
    bounds = scene.bounds
    if bounds is None:
        raise ValueError("the scene is empty, so no rays can be aimed at it")
    center = bounds[0] / 2 + bounds[1] / 2
    radius = float(np.linalg.norm(bounds[1] / 2 - bounds[0] / 2)) or 1.0
    return Camera(center + _DISTANCE * radius * _AWAY, center, fov=_FOV, width=side, height=side)


def _lamps(
    scene: Scene, camera: AnyCamera, away: float, count: int, rng: np.random.Generator
) -> NDArray[np.float64]:
    """Return `count` points (N, 3) that shine."""
    points = [light.position for light in scene.lights if hasattr(light, "position")]
    if points:
        places = np.array(points)
        return np.asarray(places[np.arange(count) % len(places)])
    meshes = [shape for shape in scene.shapes if isinstance(shape, Mesh)]
    shining = [mesh.vertices[mesh.faces] for mesh in meshes if mesh.emission]
    corners = np.concatenate([np.empty((0, 3, 3)), *shining])
    double_area = np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    if double_area.sum() > 0 and np.isfinite(double_area).all():
        face = corners[rng.choice(len(corners), count, p=double_area / double_area.sum())]
        u, v = rng.random((2, count, 1))
        over = u + v > 1
        u, v = np.where(over, 1 - u, u), np.where(over, 1 - v, v)
        return np.asarray((1 - u - v) * face[:, 0] + u * face[:, 1] + v * face[:, 2])
    return np.broadcast_to(_over_shoulder(scene, camera, away), (count, 3))


def _over_shoulder(scene: Scene, camera: AnyCamera, away: float) -> NDArray[np.float64]:
    """Return a point half as far from the camera as its view reaches; nearer, if a wall is in between."""
    eye = np.array(camera.position)
    view = camera.forward
    right = _units(np.cross(view, camera.up))
    step = 0.5 * away * _units(right + np.cross(right, view))
    wall = float(scene.intersect(eye, step, t_max=1.0).t)
    return np.asarray(eye + min(wall / 2, 1.0) * step)


def _units(vectors: ArrayLike) -> NDArray[np.float64]:
    array = np.asarray(vectors, np.float64)
    return np.asarray(array / np.linalg.norm(array, axis=-1, keepdims=True))
