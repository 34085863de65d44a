"""Creep of glue and solder: stress that a change of temperature makes and time takes away."""

from dataclasses import dataclass

import numpy as np

from hgma_compensation.simulation.effect import Array, Effect, Surroundings
from hgma_compensation.simulation.filters import low_pass
from hgma_compensation.simulation.oven import GRID


@dataclass(frozen=True)
class StressRelaxation(Effect):
    """gain: m/s²/°C of a sudden change. time_constant: s, the median of the relaxation times.

    decades: standard deviation of their decimal logarithm; 0 gives one exponential.
    """

    gain: float
    time_constant: float
    decades: float = 0.5

    def drift(self, around: Surroundings, random: np.random.Generator) -> Array:
        """Return g·(T − Σ pᵢ·LPτᵢ T) (n,), the τᵢ a log-normal spectrum of 41 times: nearly a stretched exponential."""
        places = np.linspace(-2.5, 2.5, 41) if self.decades > 0.0 else np.zeros(1)
        shares = np.exp(-0.5 * places**2) / np.exp(-0.5 * places**2).sum()
        relaxed = np.zeros_like(around.grid_temperature)
        for place, share in zip(places, shares, strict=True):
            time_constant = self.time_constant * 10.0 ** (self.decades * place)
            relaxed += share * low_pass(around.grid_temperature, float(time_constant), GRID)
        return self.gain * around.at_samples(around.grid_temperature - relaxed)
