"""A ratiometric bridge follows its supply."""

from dataclasses import dataclass

import numpy as np

from hgma_compensation.simulation.drift import normalised
from hgma_compensation.simulation.effect import Array, Effect, Surroundings


@dataclass(frozen=True)
class SupplyVoltage(Effect):
    """gain: m/s²/V. temperature_gain: m/s²/V over 35 °C."""

    needs = "supply_voltage"
    gain: float
    temperature_gain: float = 0.0

    def drift(self, around: Surroundings, random: np.random.Generator) -> Array:
        """Return (V − V0)·(a + b·x) (n,), x = (T − 25)/35."""
        return around.voltage_deviation * (self.gain + self.temperature_gain * normalised(around.temperature))
