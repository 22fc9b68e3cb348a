"""No structure."""

from dataclasses import dataclass


@dataclass(frozen=True)
class BruteForce:
    """No structure at all: every ray is tested against every primitive. The oracle for the others."""
