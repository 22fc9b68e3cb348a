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
        Number of them whose hit the CPU decided among up to four candidates. (It computes `t` and `uv` of all
        hits.)
    closest_walked : int
        Number of them that the CPU traced: those with more candidates, or out of the range of float32.
    any : int
        Number of rays tested for any hit.
    any_decided : int
        Number of them for which the CPU decided the hit of one face.
    any_walked : int
        Number of them that the CPU traced.

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
        """Share of closest-hit rays that the device did not decide."""
        return (self.closest_decided + self.closest_walked) / self.closest if self.closest else 0.0

    @property
    def any_share(self) -> float:
        """Share of any-hit rays that the device did not decide."""
        return (self.any_decided + self.any_walked) / self.any if self.any else 0.0
