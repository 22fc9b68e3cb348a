"""Statistics: rays answered by the device, and rays left to the CPU."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass
class GpuStats:
    """Statistics of the rays of a `GpuScene`, since it was put on the device.

    Attributes
    ----------
    closest : int
        Number of rays traced for their closest hit.
    closest_decided : int
        Number of them whose hit the CPU decided among up to four candidates. (Of all that hit something it
        computes `t` and `uv`.)
    closest_walked : int
        Those of them that the CPU traced by itself: there were more candidates, or the ray was not one for
        float32.
    any : int
        Number of rays tested for any hit.
    any_decided : int
        Number of them for which the CPU decided the hit of one face.
    any_walked : int
        Number of them that the CPU traced by itself.

    See Also
    --------
    GpuScene.stats : Makes it.

    Examples
    --------
    >>> stats = rw.gpu.GpuStats(closest=100, closest_decided=3, closest_walked=1)
    >>> stats.closest_share
    0.04
    """

    closest: int = 0
    closest_decided: int = 0
    closest_walked: int = 0
    any: int = 0
    any_decided: int = 0
    any_walked: int = 0

    @property
    def closest_share(self) -> float:
        """The share of rays asked for their closest hit that the device did not decide alone."""
        return (self.closest_decided + self.closest_walked) / self.closest if self.closest else 0.0

    @property
    def any_share(self) -> float:
        """The share of rays asked for any hit that the device did not decide."""
        return (self.any_decided + self.any_walked) / self.any if self.any else 0.0
