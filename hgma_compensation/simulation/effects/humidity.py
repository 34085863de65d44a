"""Moisture taken up by the package through the day; no recorded channel shows it."""

from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter

from hgma_compensation.simulation.effect import Array, Effect, Surroundings
from hgma_compensation.simulation.filters import low_pass


@dataclass(frozen=True)
class Humidity(Effect):
    """gain: m/s² per % of relative humidity. time_constant: s of uptake. swing: %, over period (s). wander: %."""

    gain: float
    time_constant: float
    swing: float
    period: float = 86400.0
    wander: float = 0.0

    def drift(self, around: Surroundings, random: np.random.Generator) -> Array:
        """Return k·(LPτ(RH) − RH0) (n,): RH a daily wave and a first-order wander of a tenth of its period."""
        wave = self.swing * np.sin(2.0 * np.pi * around.time / self.period)
        keep = float(np.exp(-10.0 * around.step / self.period))
        steps = self.wander * np.sqrt(1.0 - keep**2) * random.standard_normal(len(around.time))
        taken_up = low_pass(wave + lfilter([1.0], [1.0, -keep], steps), self.time_constant, around.step)
        return self.gain * (taken_up - taken_up[0])
