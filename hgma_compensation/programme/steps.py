"""Steps of an oven programme."""

from dataclasses import dataclass
from enum import Enum
from typing import Any


class Part(str, Enum):
    """Whether a step is learned from."""

    LEARN = "learn"
    HOLD_OUT = "hold-out"


@dataclass(frozen=True)
class PlannedStep:
    """Ramp from one temperature to another (°C) at a rate (°C/min), then a soak (min); why: what it is there for."""

    start: float
    to: float
    rate: float
    soak: float
    why: str
    part: Part

    @property
    def duration(self) -> float:
        """Ramp and soak, min."""
        return abs(self.to - self.start) / self.rate + self.soak

    def as_json(self) -> dict[str, Any]:
        """Return the figures."""
        return {
            "part": self.part.value,
            "from_celsius": self.start,
            "to_celsius": self.to,
            "rate_celsius_per_min": self.rate,
            "soak_min": self.soak,
            "duration_min": self.duration,
            "why": self.why,
        }
