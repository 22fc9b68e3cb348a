"""From scenes that change to animations."""

from __future__ import annotations

import errno
import math
import os
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, closing
from pathlib import Path
from typing import Any

import numpy as np

from ..arrays import SeedLike, integer, positive, seed_number
from ..cameras import AnyCamera
from ..io.pictures import check_writable
from ..io.tone import DEFAULT, check_tone
from ..scene.scene import Scene
from .error_estimate import ErrorEstimate
from .image import HISTORY, Image
from .render import render

Frame = tuple[Scene, AnyCamera]
# Suffixes of films.
_FILMS = (".mp4", ".mov", ".mkv", ".webm")
# libvpx-vp9 is the only codec of .webm available everywhere; H.264, the default of the others, has no odd
# sizes.
_FREE = {".webm": {"codec": "libvpx-vp9"}}
_NO_IMAGEIO = "a film needs imageio: pip install 'raywright[video]'"


def render_frames(
    frames: Callable[[int], Frame] | Iterable[Frame],
    out: str | os.PathLike[str] | Callable[[int, Image], object],
    count: int | None = None,
    *,
    seed: SeedLike = 0,
    fps: float = 24.0,
    exposure: float = 0.0,
    tone: str = DEFAULT,
    progress: bool = True,
    preview: Any = None,
    **how: Any,
) -> list[Path]:
    """Render the frames of an animation, one after the other.

    Parameters
    ----------
    frames : callable or iterable
        Scene and camera of each frame: a function of the frame's number, from 0 on, or an iterable. It may
        move a scene by `Scene.refit`, much faster than making a new one: a frame is requested after the
        previous one is done.
    out : str, path or callable
        A format string for file names, such as ``"frames/{:04}.png"``, with any suffix that `Image.save`
        takes; or a film, ``"film.mp4"`` (also .mov, .mkv, .webm), which needs imageio, and an even width and
        height except for .webm; or a function of the number and the `Image`.
    count : int, optional
        Number of frames; required with a function, a maximum for an iterable.
    seed : int, Generator or SeedSequence
        Seed of the first frame. It grows by one from frame to frame, so that noise does not stand still.
    fps : float
        Frames a second of a film.
    exposure, tone
        As for `Image.save`; the same for all frames.
    progress : bool
        True for a progress bar on stderr that counts frames.
    preview : "headlight", 3 floats, DirectionalLight or PointLight, optional
        Light of a preview: `Scene.preview` draws the frames with it instead of rendering them.
    **how
        Other arguments of `render` for all frames, such as the integrator and limits; with `preview`, of
        `Scene.preview`.

    Returns
    -------
    list of Path
        The files that were written.

    Raises
    ------
    ValueError
        If a number is out of its range, `out` has no field for the number, or a film cannot have the size of
        the frames; also as raised by `render`.
    TypeError
        If an argument is of the wrong kind, or a frame is not a scene and camera; also as raised by `render`.
    ImportError
        If imageio is missing for a film.
    OSError
        If a file cannot be written, or the encoder of a film fails.
    KeyboardInterrupt
        When Ctrl-C is pressed. Finished frames are kept, and a film ends with the last of them.

    See Also
    --------
    render : Render one picture.

    Examples
    --------
    >>> camera = rw.Camera((0, 0, 5), (0, 0, 0), width=4, height=4)
    >>> def frame(number):
    ...     return rw.Scene(rw.Sphere(emission=float(number))), camera
    >>> pictures = {}
    >>> rw.render_frames(frame, pictures.__setitem__, count=3, samples=1, progress=False)
    []
    >>> [pictures[number].rgb[1, 1, 0].item() for number in range(3)]
    [0.0, 1.0, 2.0]
    """
    count = None if count is None else integer("count", count, 0)
    seed = seed_number(seed)
    fps, exposure = positive("fps", fps), check_tone(exposure, tone)
    if not isinstance(progress, bool):
        raise TypeError(f"progress must be True or False, got {progress!r}")
    every = _each(frames, count)
    suffix = Path(out).suffix.lower() if isinstance(out, str | os.PathLike) else ""
    is_film, even = suffix in _FILMS, suffix in _FILMS and suffix not in _FREE
    with ExitStack() as stack:
        write = _writer(out, fps, exposure, tone, stack)
        written: dict[Path, None] = {}
        if progress:
            from tqdm import tqdm

            every = stack.enter_context(closing(tqdm(every, desc="frames", total=count, unit="frame")))
        for number, frame in enumerate(every):
            scene, camera = _checked(number, frame, even)
            if preview is None:
                image = render(scene, camera, seed=(seed + number) % 2**64, progress=False, **how)
            else:
                image = _previewed(number, scene, camera, preview, how)
            path = write(number, image)
            if path is not None:
                written[path] = None
    for path in written if is_film else ():
        # imageio does not report a failing encoder.
        if not path.is_file() or not path.stat().st_size:
            raise OSError(errno.EIO, "its encoder wrote no video", str(path))
    return list(written)


def _previewed(number: int, scene: Any, camera: AnyCamera, light: Any, how: dict[str, Any]) -> Image:
    """Return a preview as a picture of whose error nothing is known."""
    if not isinstance(scene, Scene):
        raise TypeError(f"scene of frame {number} must be a Scene, got {type(scene).__name__}")
    began = time.monotonic()
    pixels = scene.preview(camera, light, dtype=np.float32, **how)
    seconds = time.monotonic() - began
    unknown = ErrorEstimate(math.nan, math.nan, math.nan, False)
    nothing = np.full(pixels.shape, np.nan, np.float32)
    return Image(pixels, nothing, unknown, np.empty(0, HISTORY), seconds, 1)


def _each(frames: Callable[[int], Frame] | Iterable[Frame], count: int | None) -> Iterable[Frame]:
    if callable(frames):
        if count is None:
            raise ValueError("count must be given where frames is a function")
        return map(frames, range(count))
    try:
        found = iter(frames)
    except TypeError:
        told = type(frames).__name__
        raise TypeError(f"frames must be a function or give scenes and cameras, got {told}") from None
    return found if count is None else _first(found, count)


def _first(frames: Iterator[Frame], count: int) -> Iterator[Frame]:
    # Never more frames than wanted are computed: they may be costly.
    for _ in range(count):
        try:
            yield next(frames)
        except StopIteration:
            return


def _checked(number: int, frame: Any, even: bool) -> Frame:
    if not (isinstance(frame, tuple | list) and len(frame) == 2):
        raise TypeError(f"frame {number} must be a scene and a camera, got {type(frame).__name__}")
    scene, camera = frame
    if even and isinstance(camera, AnyCamera) and (camera.width % 2 or camera.height % 2):
        size = f"{camera.width} by {camera.height}"
        raise ValueError(
            f"frame {number} is {size}, but a video must have an even width and height, unless .webm"
        )
    return scene, camera


def _writer(
    out: str | os.PathLike[str] | Callable[[int, Image], object],
    fps: float,
    exposure: float,
    tone: str,
    stack: ExitStack,
) -> Callable[[int, Image], Path | None]:
    """Return the sink of pictures, which returns the file of each."""
    if callable(out):

        def hand(number: int, image: Image) -> None:
            out(number, image)

        return hand
    if not isinstance(out, str | os.PathLike):
        raise TypeError(f"out must be a path or a function, got {type(out).__name__}")
    name = os.fspath(out)
    if Path(name).suffix.lower() in _FILMS:
        return _film(check_writable(name, _FILMS, "a film"), fps, exposure, tone, stack)
    try:
        names = [name.format(number) for number in (0, 1)]
    except (IndexError, KeyError, ValueError) as error:
        raise ValueError(f"out must have one place for the frame's number, got {name!r}") from error
    if names[0] == names[1]:
        raise ValueError(f"out must have a place for the frame's number, as {{:04}} is, got {name!r}")
    check_writable(names[0])

    def save(number: int, image: Image) -> Path:
        path = Path(name.format(number))
        image.save(path, exposure, tone)
        return path

    return save


def _film(
    path: Path, fps: float, exposure: float, tone: str, stack: ExitStack
) -> Callable[[int, Image], Path | None]:
    try:
        import imageio
    except ImportError as error:
        raise ImportError(_NO_IMAGEIO) from error

    # Keeps the size: imageio's default stretches pictures to multiples of 16.
    how = _FREE.get(path.suffix.lower(), {})
    film = stack.enter_context(closing(imageio.get_writer(path, fps=fps, macro_block_size=1, **how)))

    def add(_number: int, image: Image) -> Path:
        film.append_data(image.srgb(exposure, tone)[..., :3])
        return path

    return add
