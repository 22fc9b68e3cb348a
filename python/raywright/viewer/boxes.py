"""Boxes of an accelerator over a picture."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..cameras import AnyCamera, Camera, Orthographic, ThinLens

# Corners share an edge if their numbers differ in one bit.
_EDGES = np.array([(i, i | 1 << bit) for i in range(8) for bit in range(3) if not i >> bit & 1])
# Most boxes drawn: the largest of a level.
_MOST = 20_000
# Least distance of drawn lines, relative to the farthest: nearer ones have no place in the picture.
_NEAREST = 1e-6
# Extent of lines beyond the picture, in picture widths, and their color.
_BESIDE = 4.0
_COLOR = (255, 208, 0)


def check_flat(camera: AnyCamera) -> None:
    """Raise a ValueError unless straight edges are straight in a camera's picture."""
    if not isinstance(camera, Camera | ThinLens | Orthographic):
        kind = type(camera).__name__
        kinds = "a Camera, ThinLens or Orthographic"
        raise ValueError(f"boxes are drawn for {kinds}, and the camera is a {kind}")


def edges(camera: AnyCamera, corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return where the edges of boxes are seen.

    Parameters
    ----------
    camera : Camera, ThinLens or Orthographic
        Camera, as the shutter opens.
    corners : (K, 8, 3) array
        Of boxes, as in `TreeBoxes`.

    Returns
    -------
    (E, 2, 2) float64
        The ends of edges, clipped to the part in front of the camera, from (0, 0) at the upper left of the
        picture to (1, 1) at its lower right.
    """
    corners = largest(corners)
    ends = corners[:, _EDGES].reshape(-1, 2, 3)
    origins, ways = spread(camera)
    # Coordinates across, down and along rays: from the origins of parallel rays, or where a direction meets a
    # plane.
    axes = np.stack([*origins[1:], ways[0]] if isinstance(camera, Orthographic) else [*ways[1:], ways[0]])
    seen = (ends - origins[0]) @ np.linalg.inv(axes)
    cut = seen[..., 2]
    nearest = _NEAREST * max(float(np.abs(cut).max(initial=0.0)), np.finfo(float).tiny)
    seen = _in_front(seen, cut - nearest)
    ends = seen[..., :2] if isinstance(camera, Orthographic) else seen[..., :2] / seen[..., 2:]
    beside = (np.abs(ends - 0.5) > _BESIDE).any(axis=(1, 2))
    return ends[~beside]


def largest(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return boxes, (K, 8, 3), the largest first; of more than 20,000 those alone."""
    size = np.linalg.norm(np.ptp(corners, axis=1), axis=1)
    return corners[np.argsort(-size, kind="stable")[:_MOST]]


def spread(camera: AnyCamera) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return how the rays of a camera spread over its picture; edges must be straight there (`check_flat`).

    Returns
    -------
    origins, ways : (3, 3) float64
        The ray at the upper left of the picture, its increment across the picture, and its increment down:
        origins and directions, at no particular length.
    """
    picture = np.array([(0, 0), (camera.width, 0), (0, camera.height), (camera.width, camera.height)], float)
    origins, ways = camera.rays_through(picture)
    if not isinstance(camera, Orthographic):
        # Scales the directions to the corners of a plane, so that they form a parallelogram.
        lengths = np.linalg.svd(np.stack([ways[0], -ways[1], -ways[2], ways[3]], axis=1))[2][-1]
        ways = ways * (lengths * np.sign(lengths[0]))[:, np.newaxis]
    starts, towards = (np.stack([one[0], one[1] - one[0], one[2] - one[0]]) for one in (origins, ways))
    return starts, towards


def drawn(pixels: NDArray[np.uint8], lines: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Return a picture, (H, W, 3), with the lines of `edges` drawn over it."""
    from PIL import Image, ImageDraw

    image = Image.fromarray(pixels)
    draw = ImageDraw.Draw(image)
    for line in lines * image.size:
        draw.line([tuple(end) for end in line.tolist()], fill=_COLOR, width=1)
    return np.asarray(image)


def _in_front(ends: NDArray[np.float64], cut: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return edges (E, 2, C), or parts of them, where a number (E, 2) that is even along them is above 0."""
    seen = (cut > 0).any(axis=1)
    ends, cut = ends[seen], cut[seen]
    for one, other in ((0, 1), (1, 0)):
        behind = cut[:, one] <= 0
        share = (cut[behind, other] / (cut[behind, other] - cut[behind, one]))[:, np.newaxis]
        ends[behind, one] = ends[behind, other] + share * (ends[behind, one] - ends[behind, other])
    return ends
