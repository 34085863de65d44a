"""Bending of the package by a difference of temperature across it."""

from dataclasses import dataclass

import numpy as np

from hgma_compensation.simulation.drift import normalised
from hgma_compensation.simulation.effect import Array, Effect, Surroundings


@dataclass(frozen=True)
class ThermalGradient(Effect):
    """gain: m/s²/°C. bend: relative change of the gain over 35 °C."""

    needs = "second_thermometer"
    gain: float
    bend: float = 0.0

    def drift(self, around: Surroundings, random: np.random.Generator) -> Array:
        """Return k·(T2 − T1)·(1 + c·x) (n,), x = (T1 − 25)/35."""
        difference = around.temperature_2 - around.temperature
        return self.gain * difference * (1.0 + self.bend * normalised(around.temperature))
