"""A bias made by vibration along the axis, of whatever frequency."""

from dataclasses import dataclass

import numpy as np

from hgma_compensation.simulation.effect import Array, Effect, Surroundings
from hgma_compensation.simulation.filters import low_pass


@dataclass(frozen=True)
class VibrationRectification(Effect):
    """coefficient: m/s² per (m/s²)². time_constant: s by which the bias follows the power."""

    coefficient: float
    time_constant: float

    def drift(self, around: Surroundings, random: np.random.Generator) -> Array:
        """Return k·LPτ(mean square of the vibration) (n,)."""
        return self.coefficient * low_pass(around.vibration_power, self.time_constant, around.step)
