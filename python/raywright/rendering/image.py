"""Pictures with their error."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from .. import _core
from ..arrays import frozen, number, same, thread_limit
from ..io import pictures, shown
from ..io.tone import DEFAULT, check_tone
from .denoising import check_method, denoised
from .error_estimate import ErrorEstimate
from .halves import Halves
from .plan import Choice, RenderPlan

_UNSURE = "few samples tell the error of the denoised picture: it cannot be trusted yet"
HISTORY = np.dtype([("seconds", np.float64), ("samples", np.int64), ("error", np.float64)])


@dataclass(frozen=True, eq=False, repr=False)
class Image:
    """A picture that `render` made. Row 0 is the top.

    Arrays are read-only. ``np.asarray(image)`` is a copy of `rgb` that can be written to.

    Attributes
    ----------
    rgb : (H, W, 3) float32
        Linear red, green and blue: radiance in W·sr⁻¹·m⁻². In a transparent picture, colors are premultiplied
        by alpha.
    standard_error : (H, W, 3) float32
        Standard error of `rgb`, by each pixel's own samples. Its square is unbiased. With few batches of
        samples it is uncertain itself; use `interval` then.
    error : ErrorEstimate
        relMSE of the whole picture, with its 95 % interval.
    history : (K,) structured array
        Fields ``seconds`` (float64), ``samples`` (int64, per pixel) and ``error`` (float64, relMSE), over the
        course of the render.
    seconds : float
        Run time of the render.
    samples : int
        Samples per pixel; their mean if the render was adaptive.
    warnings : tuple of str
        Reasons to distrust the picture; empty if there are none.
    biased : bool
        True if the expectation differs from the true radiance: clamped samples make it darker, photon maps
        (`bias`) and the denoiser blur it.
    aov : dict of str to (H, W, ...) arrays
        Auxiliary buffers by name: those that `aov` of `render` requested, and ``samples`` (uint32) of each
        pixel if the render was adaptive.
    plan : RenderPlan
        Options that were chosen automatically, such as the sampler, with reasons.
    pooled_error : (H, W, 3) float32, optional
        Standard error pooled over neighboring pixels, for `interval`, because one pixel has few batches. If
        not given, `standard_error` is used.
    degrees : (H, W) float32, optional
        Degrees of freedom of `pooled_error`; infinite if not given.
    alpha : (H, W) float32, optional
        Covered share of each pixel, for a transparent background; filters with negative lobes may exceed 0..1
        slightly.
    bias : (H, W, 3) float32, optional
        Estimated bias of each pixel by the blur of photon maps; None without photon maps. It is not included
        in `standard_error` and `error`. It is estimated from at most 16 samples, each with disks of the
        radius r, of r/√2 and of r/2 about the same points and with the same photons (see `PhotonMap`). The
        bias is twice the difference of the first two, assuming it is proportional to r²; or four times that
        of the last two, if that is larger and they differ by more than four standard errors. A bias that is
        equal in all three disks, such as at the edge of a shadow through the point, is not included.
    bias_error : (H, W, 3) float32, optional
        Standard error of `bias`, from groups of its samples; it often exceeds the bias.
    halves : Halves, optional
        Two independent halves of the picture, for `denoise`; ``halves`` of `render` keeps them.

    See Also
    --------
    render : Makes it.

    Examples
    --------
    >>> camera = rw.Camera((0, 0, 5), (0, 0, 0), fov=10, width=4, height=4)
    >>> image = rw.render(rw.Scene(rw.Sphere(emission=2.0)), camera, samples=4, progress=False)
    >>> image.rgb[2, 2].tolist(), image.standard_error[2, 2].tolist()
    ([2.0, 2.0, 2.0], [0.0, 0.0, 0.0])
    >>> image.biased, image.warnings
    (False, ())
    """

    rgb: NDArray[np.float32]
    standard_error: NDArray[np.float32]
    error: ErrorEstimate
    history: NDArray[np.void]
    seconds: float
    samples: int
    warnings: tuple[str, ...] = ()
    biased: bool = False
    aov: Mapping[str, NDArray[Any]] = field(default_factory=dict)
    plan: RenderPlan = field(default_factory=RenderPlan)
    pooled_error: NDArray[np.float32] | None = None
    degrees: NDArray[np.float32] | None = None
    alpha: NDArray[np.float32] | None = None
    bias: NDArray[np.float32] | None = None
    bias_error: NDArray[np.float32] | None = None
    halves: Halves | None = None

    def __post_init__(self) -> None:
        for name in ("rgb", "standard_error", "history"):
            object.__setattr__(self, name, frozen(getattr(self, name)))
        object.__setattr__(self, "aov", {name: frozen(array) for name, array in self.aov.items()})
        for name in ("pooled_error", "degrees", "alpha", "bias", "bias_error"):
            if getattr(self, name) is not None:
                object.__setattr__(self, name, frozen(getattr(self, name)))

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> NDArray[Any]:
        """Return `rgb`, for ``np.asarray(image)``.

        Parameters
        ----------
        dtype : dtype, optional
            That of `rgb` if not given, float32.
        copy : bool, optional
            Whether the array is a new one, which can be written to, so that torch wraps it without a warning.
            If False it is `rgb` itself, which cannot.

        Returns
        -------
        (H, W, 3) array

        Raises
        ------
        ValueError
            If `copy` is False and the dtype is another one.
        """
        if copy is not False:
            return np.array(self.rgb, dtype)
        if dtype is not None and np.dtype(dtype) != self.rgb.dtype:
            raise ValueError(f"copy must not be False for dtype {np.dtype(dtype)}: rgb is {self.rgb.dtype}")
        return self.rgb

    def interval(self, level: float = 0.95) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Return a confidence interval for every pixel.

        The ends are `rgb` ± `pooled_error` times a quantile of Student's t. No estimate includes light that
        no sample found.

        Parameters
        ----------
        level : float
            Confidence level, above 0 and below 1.

        Returns
        -------
        low, high : (H, W, 3) float32
            NaN if there are too few samples.

        Raises
        ------
        ValueError
            If `level` is out of its range.
        TypeError
            If `level` is not a number.

        See Also
        --------
        ErrorEstimate : The error of the whole picture.

        Examples
        --------
        >>> scene = rw.Scene(rw.Sphere(), environment=1.0)
        >>> camera = rw.Camera((0, 0, 5), (0, 0, 0), width=4, height=4)
        >>> image = rw.render(scene, camera, samples=16, progress=False)
        >>> low, high = image.interval(0.99)
        >>> bool((low <= image.rgb).all() and (image.rgb <= high).all())
        True
        """
        level = number("level", level)
        if not 0 < level < 1:
            raise ValueError(f"level must be between 0 and 1, got {level:g}")
        # Few distinct values: whole numbers rather than one per pixel.
        degrees = np.full((1, 1), 1e9) if self.degrees is None else np.floor(self.degrees.astype(float))
        unique, where = np.unique(np.nan_to_num(degrees.clip(1, 1e9), nan=1), return_inverse=True)
        times = _core.student(level, unique)[where].reshape(degrees.shape)[..., None]
        away = times * (self.standard_error if self.pooled_error is None else self.pooled_error)
        return (self.rgb - away).astype(np.float32), (self.rgb + away).astype(np.float32)

    def denoise(self, method: str = "regression", *, threads: int | None = None) -> Image:
        """Return a denoised picture, with its error.

        Each half of the samples is filtered by itself, with several filters. A quarter of the samples, from
        the other half, selects the best filter for each pixel, or none; the last quarter measures the error
        of the result. So `error` is that of the returned picture, blur included, unbiased and with an
        interval, as for unfiltered pictures.

        Parameters
        ----------
        method : str
            Method of filtering. ``"regression"``: each pixel by a fit to the albedo, normal and depth of the
            pixels around that look like it (NFOR, Bitterli et al. 2016). ``"oidn"``: by Open Image Denoise, a
            neural network (``pip install 'raywright[oidn]'``).
        threads : int, optional
            Number of threads; all cores if not given. Open Image Denoise sets its own number of threads.

        Returns
        -------
        Image
            The denoised picture. `standard_error` is the error of pixels, blur included, estimated in squares
            of 13 by 13 pixels. `plan` has a row about it; `biased` is True, and `halves` and other fields
            that describe the noisy picture are None.

        Raises
        ------
        ValueError
            If the picture has no halves, or the method is not known.
        ImportError
            If Open Image Denoise is asked for and missing.
        TypeError
            If `threads` is not an integer.

        See Also
        --------
        render : Takes `denoise` and `halves`.

        Notes
        -----
        No estimate includes light that no sample found. If the error of the noisy picture is not trusted,
        that of the denoised one is not either. Below some 10,000 pixels intervals are wide, since only one
        quarter of the samples measures the error.

        Examples
        --------
        >>> scene = rw.Scene([rw.Plane(), rw.Sphere((0, 0, 1))], environment=1.0)
        >>> camera = rw.Camera((0, -6, 2), (0, 0, 1), up=(0, 0, 1), width=24, height=24)
        >>> noisy = rw.render(scene, camera, samples=16, halves=True, progress=False)
        >>> clean = noisy.denoise()
        >>> clean.biased, clean.error.estimate < noisy.error.estimate
        (True, True)
        """
        method = check_method("method", method)
        threads = thread_limit(threads)
        if any(row.what == "denoised" for row in self.plan.rows):
            raise ValueError("the picture is already denoised")
        if self.halves is None:
            raise ValueError(
                "the picture has no halves, which denoising needs: render it with halves=True, and at least "
                "four samples per pixel, or four batches of those of a sampler with batches"
            )
        began = time.monotonic()
        found = denoised(self.halves, method, threads)
        row = Choice(
            "denoised", method, "each pixel in the way that the other half of the samples finds best"
        )
        trusted = found.trusted and self.error.trusted
        told = () if trusted or not self.error.trusted else (_UNSURE,)
        return replace(
            self,
            rgb=found.rgb,
            standard_error=found.off,
            error=ErrorEstimate(*found.error, trusted=trusted),
            seconds=self.seconds + time.monotonic() - began,
            warnings=(*self.warnings, *told),
            biased=True,
            plan=replace(self.plan, rows=(*self.plan.rows, row)),
            pooled_error=None,
            degrees=None,
            bias=None,
            bias_error=None,
            halves=None,
        )

    def srgb(self, exposure: float = 0.0, tone: str = DEFAULT) -> NDArray[np.uint8]:
        """Return the tone-mapped picture as 8-bit sRGB.

        Parameters
        ----------
        exposure : float
            Exposure in stops: 1 is twice as bright.
        tone : str
            Tone mapping of values brighter than white: ``"filmic"`` keeps colors up to half of white
            unchanged, and compresses brighter ones by the shoulder of the Khronos PBR Neutral tone mapper
            (Khronos Group, 2024); ``"linear"`` clips.

        Returns
        -------
        (H, W, 3) or (H, W, 4) uint8
            Red, green and blue; transparent pictures also have alpha, not premultiplied.

        Raises
        ------
        ValueError
            If the exposure is out of -100..100, or the tone is not known.
        TypeError
            If the exposure is not a number.

        See Also
        --------
        Image.save : Write the picture to a file.

        Examples
        --------
        >>> camera = rw.Camera((0, 0, 5), (0, 0, 0), width=4, height=4)
        >>> image = rw.render(rw.Scene(rw.Sphere(emission=0.2)), camera, samples=1, progress=False)
        >>> image.srgb()[2, 2].tolist(), image.srgb(exposure=-1)[2, 2].tolist()
        ([124, 124, 124], [89, 89, 89])
        """
        return shown.srgb(self.rgb, self.alpha, check_tone(exposure, tone), tone)

    def save(self, path: str | PathLike[str], exposure: float = 0.0, tone: str = DEFAULT) -> None:
        """Save the picture.

        Parameters
        ----------
        path : str or path
            ``.png``, ``.jpg``, ``.jpeg``, ``.webp`` and ``.avif`` hold the 8 bits of `srgb`, with alpha if
            the picture has one. JPEG has no alpha: the background is black. ``.npy`` holds `rgb`. ``.exr``
            holds `rgb` as channels R, G, B, `alpha` as A, `standard_error` as standard_error.R, .G, .B, and
            the buffers of `aov` as layers of 32-bit floats, as compositing programs call them: depth.Z,
            normal.X, .Y, .Z, albedo.R, .G, .B, and so on. Indices are of 32 bits without a sign (4294967295
            for none), shapes also as Cryptomatte 1.2, by the names "shape 0", "shape 1", ...
        exposure : float
            Exposure of 8-bit pictures, in stops.
        tone : str
            ``"filmic"`` or ``"linear"``, see `srgb`. Files of numbers are not tone-mapped.

        Raises
        ------
        ValueError
            If the suffix is not supported, the exposure is out of -100..100, or the tone is not known.
        ImportError
            If the suffix is one that the installed Pillow cannot write.
        OSError
            If the file cannot be written: FileNotFoundError if the folder is missing, and so on.

        See Also
        --------
        io.check_writable : Check a name before the render.
        Image.srgb : The 8-bit numbers.

        Examples
        --------
        >>> import os
        >>> camera = rw.Camera((0, 0, 5), (0, 0, 0), width=4, height=4)
        >>> image = rw.render(rw.Scene(rw.Sphere(emission=0.5)), camera, samples=1, progress=False)
        >>> image.save("ball.png")
        >>> os.path.exists("ball.png")
        True
        """
        exposure, path = check_tone(exposure, tone), pictures.check_writable(path)
        suffix = path.suffix.lower()
        if suffix == ".npy":
            np.save(path, self.rgb)
        elif suffix == ".exr":
            # Imported here, because only this format needs it (import time).
            from ..io.exr.layers import write_layers

            write_layers(path, self.rgb, self.standard_error, self.alpha, self.aov)
        else:
            alpha = None if shown.FORMATS[suffix] == "JPEG" else self.alpha
            path.write_bytes(shown.encoded(shown.srgb(self.rgb, alpha, exposure, tone), suffix))

    def table(self, rows: int = 12) -> str:
        """Return error against time as lines of text: seconds, samples per pixel, relMSE.

        Parameters
        ----------
        rows : int
            Maximum number of rows; a longer history is thinned to even factors of samples.

        Returns
        -------
        str
            A line for each row, under a heading.

        See Also
        --------
        report.convergence : The error of several methods against time.

        Examples
        --------
        >>> camera = rw.Camera((0, 0, 5), (0, 0, 0), width=4, height=4)
        >>> image = rw.render(rw.Scene(rw.Sphere(), environment=1.0), camera, samples=4, progress=False)
        >>> print(image.table().splitlines()[0])
          seconds   samples     relMSE
        """
        lines = [f"{'seconds':>9} {'samples':>9} {'relMSE':>10}"]
        for i in _thinned(self.history["samples"], rows):
            seconds, samples, error = self.history[i].item()
            told = "-" if math.isnan(error) else f"{error:.4g}"
            lines.append(f"{seconds:9.2f} {samples:9d} {told:>10}")
        return "\n".join(lines)

    def _extent(self) -> tuple[int, int]:
        """Return width and height in pixels."""
        height, width = self.rgb.shape[:2]
        return width, height

    def _repr_png_(self) -> bytes:
        return shown.png(self.rgb, self.alpha)

    def _ipython_display_(self) -> None:
        # The notebook already shows the picture under the cell that rendered it: numbers are enough there.
        is_shown = vars(self).get("_is_shown")
        if is_shown is None or not is_shown():
            # Makes IPython continue as if there were no such method.
            raise NotImplementedError
        print(repr(self))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Image):
            return NotImplemented
        return (
            same(self.rgb, other.rgb)
            and same(self.standard_error, other.standard_error)
            and all(same(self.history[name], other.history[name]) for name in HISTORY.names or ())
            and (self.error, self.seconds, self.samples, self.warnings, self.biased)
            == (other.error, other.seconds, other.samples, other.warnings, other.biased)
            and self.plan == other.plan
            and same(self.pooled_error, other.pooled_error)
            and same(self.degrees, other.degrees)
            and same(self.alpha, other.alpha)
            and same(self.bias, other.bias)
            and same(self.bias_error, other.bias_error)
            and self.halves == other.halves
            and self.aov.keys() == other.aov.keys()
            and all(same(array, other.aov[name]) for name, array in self.aov.items())
        )

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[Any, ...]:
        # Through the constructor, because unpickled arrays would be writeable.
        parts = (
            self.rgb,
            self.standard_error,
            self.error,
            self.history,
            self.seconds,
            self.samples,
            self.warnings,
            self.biased,
            self.aov,
            self.plan,
            self.pooled_error,
            self.degrees,
            self.alpha,
            self.bias,
            self.bias_error,
            self.halves,
        )
        return Image, parts

    def __repr__(self) -> str:
        width, height = self._extent()
        parts = [
            f"{width}x{height}",
            f"{self.samples} samples",
            f"{self.seconds:.2f} s",
            f"relMSE {self.error}",
        ]
        return f"Image({', '.join([*parts, *self.warnings])})"


def _thinned(samples: NDArray[np.int64], rows: int) -> list[int]:
    count = len(samples)
    if count <= rows:
        return list(range(count))
    wanted = np.geomspace(max(int(samples[0]), 1), max(int(samples[-1]), 1), max(rows, 2))
    return sorted(
        {min(int(i), count - 1) for i in np.searchsorted(samples, wanted * (1 - 1e-12))} | {count - 1}
    )
