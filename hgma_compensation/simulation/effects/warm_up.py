"""Self-heating after each power-on."""

from dataclasses import dataclass

import numpy as np

from hgma_compensation.simulation.effect import Array, Effect, Surroundings
from hgma_compensation.simulation.filters import low_pass


@dataclass(frozen=True)
class WarmUp(Effect):
    """amplitude: m/s² of a cold start. time_constant: s, of warming and of cooling while off."""

    amplitude: float
    time_constant: float

    def drift(self, around: Surroundings, random: np.random.Generator) -> Array:
        """Return A·(1 − s) (n,), s the low-passed power: A·e^(−t/τ) after a cold start, less after a short break."""
        # Before the first sample the sensor was off: the power is preceded by a zero, at which the filter settles.
        power = np.r_[0.0, around.powered.astype(np.float64)]
        return self.amplitude * (1.0 - low_pass(power, self.time_constant, around.step)[1:])
