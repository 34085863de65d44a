"""A loop whose width grows with a power of the ramp rate."""

from dataclasses import dataclass

import numpy as np

from hgma_compensation.simulation.effect import Array, Effect, Surroundings


@dataclass(frozen=True)
class RateDependentHysteresis(Effect):
    """amplitude: m/s², half the loop at 1 °C/min. exponent: of the rate."""

    amplitude: float
    exponent: float

    def drift(self, around: Surroundings, random: np.random.Generator) -> Array:
        """Return A·sgn(Ṫ)·|Ṫ / (1 °C/min)|^p (n,)."""
        per_minute = 60.0 * around.rate
        return np.asarray(self.amplitude * np.sign(per_minute) * np.abs(per_minute) ** self.exponent)
