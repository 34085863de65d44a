"""A loop that does not depend on the rate: friction and dislocations in die attach and metal."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.simulation.drift import normalised
from hgma_compensation.simulation.effect import Array, Effect, Surroundings

PLAYS = 200
RESOLUTION = 0.005
"""°C: the temperature is followed in steps of this size."""


@dataclass(frozen=True)
class Hysteresis(Effect):
    """width: m/s² of the major loop at 25 °C, heating below cooling. threshold: °C, mean of the plays'. skew: bend.

    A generalised Prandtl-Ishlinskii operator (Al Janaideh, Rakheja, Su 2011): 200 plays with exponentially
    distributed thresholds, each of a bent output, so that the loop is 1 + skew times as wide at 25 °C as far from
    it. No sum of a few plays is this.
    """

    width: float
    threshold: float
    skew: float = 0.3

    def drift(self, around: Surroundings, random: np.random.Generator) -> Array:
        """Return Σ gᵣ·(p(playᵣ T) − p(T)) (n,), p the bend; zero at first, a material without a past."""
        kept = _turning_samples(around.grid_temperature)
        temperature = around.grid_temperature[kept]
        # Thresholds at the centres of equal shares of the distribution, so that each play weighs the same.
        thresholds = -self.threshold * np.log1p(-(np.arange(PLAYS) + 0.5) / PLAYS)
        loop = self._mean_of_plays(temperature, thresholds) - self._bend(temperature)
        loop *= self.width / (2.0 * thresholds.mean())
        return np.interp(around.time, around.grid[kept], loop)

    def _bend(self, temperature: Array) -> Array:
        """Return an increasing function (n,) in °C, of slope 1 at 25 °C and 1/(1 + skew) far from it."""
        x = normalised(temperature)
        return np.asarray(35.0 * (x + 0.5 * self.skew * np.tanh(2.0 * x)) / (1.0 + self.skew))

    def _mean_of_plays(self, temperature: Array, thresholds: Array) -> Array:
        """Return the mean of p(w) (m,), each play through w = min(max(w, T − r), T + r)."""
        state = np.full(len(thresholds), temperature[0])
        means = np.empty(len(temperature))
        for index, value in enumerate(temperature):
            np.clip(state, value - thresholds, value + thresholds, out=state)
            means[index] = self._bend(state).mean()
        return means


def _turning_samples(temperature: Array) -> NDArray[np.int64]:
    """Return indices of samples that follow the temperature to within RESOLUTION, first and last included."""
    level = np.rint(temperature / RESOLUTION)
    changed = np.flatnonzero(np.diff(level)) + 1
    return np.unique(np.r_[0, changed, len(temperature) - 1])
