"""Memories of the acceleration: state machines that each sample moves on."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.effects.sample_times import GAP, NEVER, factors, put_halves, seconds_before
from hgma_compensation.effects.shock_sums import ShockSums
from hgma_compensation.kalman.low_pass import low_pass
from hgma_compensation.stamps import Stamps

__all__ = ["ShockSums", "VibrationLevel"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class VibrationLevel:
    """Low-pass of half the squared successive difference (von Neumann et al. 1941): the variance of what is fast.

    floor: what it is at rest, by noise alone; the level is that above it, so that it starts where it stays at rest.
    State: level, last acceleration, s and ns of its stamp. After a gap the level is held.
    """

    time_constant: float
    floor: float = 0.0

    @property
    def size(self) -> int:
        """Return the size of the state."""
        return 4

    def start(self) -> Array:
        """Return the state of a sensor at rest."""
        return np.array([0.0, 0.0, NEVER, 0.0])

    def run(self, state: Array, stamps: Stamps, acceleration: Array) -> Array:
        """Return the states (n, 4) after each sample; no bit differs however the samples are split."""
        seconds = seconds_before(state[2:], stamps)
        # An infinite sample must not warn, nor get stuck in the level.
        value = np.where(np.isfinite(acceleration), acceleration, np.nan)
        difference = value - np.concatenate([state[1:2], value[:-1]])
        power = 0.5 * difference * difference
        usable = (seconds > 0.0) & (seconds <= GAP) & np.isfinite(power)
        keeps = np.where(usable, 1.0 + np.expm1(np.maximum(seconds, 0.0) / -self.time_constant), 1.0)
        states = np.empty((len(stamps), self.size))
        states[:, 0] = low_pass(float(state[0]), factors(keeps), np.where(usable, power - self.floor, 0.0))[1:]
        states[:, 1] = value
        put_halves(states, stamps)
        return states

    def raised(self, state: Array, by: float) -> Array:
        """Return the state (4,) of a sensor that showed ``by`` more in all samples so far."""
        return state + np.array([0.0, by, 0.0, 0.0])
