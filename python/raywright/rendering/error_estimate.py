"""The estimated error of a picture, with its interval."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True, eq=False)
class ErrorEstimate:
    """An estimate of the relative mean squared error (relMSE) of a picture, with its 95 % interval.

    relMSE is the mean of (x - ref)² / (ref² + 0.01) over pixels and channels. ``float()`` gives the estimate.
    It is computed from the samples, so it cannot include light that no sample found.

    Attributes
    ----------
    estimate, low, high : float
        The estimate, and the ends of its interval; NaN if there are too few samples.
    trusted : bool
        True if many samples support the estimate. False if a few samples carry more than half of the
        estimate, so that one more or fewer would change it; or if the ends of the interval differ by more
        than a factor of thirty. Bright samples that all neighboring pixels confirm, as on the rim of a lamp,
        are not such rare samples.

    See Also
    --------
    Image.interval : The errors of single pixels.
    render : Takes a limit on the error.

    Examples
    --------
    >>> scene = rw.Scene(rw.Sphere(), environment=1.0)
    >>> camera = rw.Camera((0, 0, 5), (0, 0, 0), width=8, height=8)
    >>> error = rw.render(scene, camera, samples=64, progress=False).error
    >>> error.low <= float(error) <= error.high, error.trusted
    (True, True)
    """

    estimate: float
    low: float
    high: float
    trusted: bool = True

    def __float__(self) -> float:
        return self.estimate

    def __format__(self, spec: str) -> str:
        return format(self.estimate, spec) if spec else str(self)

    def __str__(self) -> str:
        if math.isnan(self.estimate):
            return "unknown"
        doubt = "" if self.trusted else ", not to be trusted yet"
        return f"{self.estimate:.3g} (95 % interval {self.low:.3g} to {self.high:.3g}{doubt})"

    def _key(self) -> tuple[float | bool | None, ...]:
        # NaN does not equal itself, but unknown errors compare equal.
        numbers = (self.estimate, self.low, self.high)
        return (*(None if math.isnan(x) else x for x in numbers), self.trusted)

    def __eq__(self, other: object) -> bool:
        return self._key() == other._key() if isinstance(other, ErrorEstimate) else NotImplemented

    def __hash__(self) -> int:
        return hash(self._key())
