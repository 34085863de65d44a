"""The memories of the acceleration sample by sample: what those in bulk are held to."""

from dataclasses import dataclass, fields
from math import isfinite

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.stamps import NANOSECONDS, Stamps, seconds_between

Array = NDArray[np.float64]

GAP = 10.0
"""Longest time between samples, s, over which the acceleration before says anything about that after."""

_NEVER = -1e9
"""Second of the stamp before the first: further back than a gap."""


def _steps(before: Array, stamps: Stamps) -> Array:
    """Return the seconds (n,) from each sample's predecessor; before: (2,) s and ns of the first one's."""
    last = int(before[0]) * NANOSECONDS + int(before[1])
    return seconds_between(stamps, np.concatenate([np.array([last], dtype=np.int64), stamps[:-1]]))


def _halves(stamps: Stamps) -> Array:
    """Return stamps as s and ns (n, 2), which a float64 holds exactly."""
    return np.column_stack(np.divmod(stamps, NANOSECONDS)).astype(np.float64)


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
        return np.array([0.0, 0.0, _NEVER, 0.0])

    def run(self, state: Array, stamps: Stamps, acceleration: Array) -> Array:
        """Return the states (n, 4) after each sample."""
        seconds = _steps(state[2:], stamps)
        # An infinite sample must not warn, nor get stuck in the level.
        value = np.where(np.isfinite(acceleration), acceleration, np.nan)
        difference = value - np.concatenate([state[1:2], value[:-1]])
        power = 0.5 * difference * difference
        usable = (seconds > 0.0) & (seconds <= GAP) & np.isfinite(power)
        weights = np.where(usable, -np.expm1(np.maximum(seconds, 0.0) / -self.time_constant), 0.0)
        levels = _low_pass(float(state[0]), weights, np.where(usable, power - self.floor, 0.0))
        return np.column_stack([levels, value, _halves(stamps)])

    def raised(self, state: Array, by: float) -> Array:
        """Return the state (4,) of a sensor that showed ``by`` more in all samples so far."""
        return state + np.array([0.0, by, 0.0, 0.0])


def _low_pass(level: float, weights: Array, inputs: Array) -> Array:
    levels = np.empty(len(inputs))
    for index, (weight, value) in enumerate(zip(weights.tolist(), inputs.tolist(), strict=True)):
        level += weight * (value - level)
        levels[index] = level
    return levels


@dataclass
class _Sums:
    """Sums over shocks (permanent, decaying), the present shock (peak, what is left of it) and the level about it."""

    permanent: float
    decaying: float
    peak: float
    remainder: float
    quiet: float
    above: float
    level: float

    def pass_time(self, seconds: float, decay: float, merge: float) -> None:
        """Let the sums decay; forget the present shock once it is over."""
        self.decaying *= decay
        self.remainder *= decay
        self.above = self.above + seconds if self.quiet == 0.0 else 0.0
        self.quiet += seconds
        if self.quiet > merge:
            self.peak = self.remainder = 0.0

    def set_peak(self, peak: float) -> None:
        """Let the present shock count with this peak."""
        self.permanent += peak - self.peak
        self.decaying += peak - self.remainder
        self.peak = self.remainder = peak


@dataclass(frozen=True)
class ShockSums:
    """Sum of the signed peaks of all shocks, and the same with each of them decaying from its peak on.

    Samples that differ from the level of the quiet ones by more than the threshold, within MERGE seconds of each
    other, are one shock; its peak is the difference largest in magnitude. Differences that last for LASTING seconds
    without a break are a new level. The state ends with the s and ns of the last stamp.
    """

    threshold: float
    time_constant: float

    MERGE, LASTING, LEVEL_TIME = 1.0, 3.0, 1.0

    @property
    def size(self) -> int:
        """Return the size of the state."""
        return len(fields(_Sums)) + 2

    def start(self) -> Array:
        """Return the state of a sensor that has seen no shock."""
        return np.array([0.0] * len(fields(_Sums)) + [_NEVER, 0.0])

    def run(self, state: Array, stamps: Stamps, acceleration: Array) -> Array:
        """Return the states (n, 9) after each sample."""
        sums = _Sums(*state[:-2].tolist())
        seconds = np.maximum(_steps(state[-2:], stamps), 0.0)
        decays, weights = np.exp(seconds / -self.time_constant), -np.expm1(seconds / -self.LEVEL_TIME)
        steps = zip(seconds.tolist(), decays.tolist(), weights.tolist(), acceleration.tolist(), strict=True)
        states = [self._move(sums, *step) for step in steps]
        return np.column_stack([np.array(states).reshape(-1, len(fields(_Sums))), _halves(stamps)])

    def raised(self, state: Array, by: float) -> Array:
        """Return the state (9,) of a sensor that showed ``by`` more in all samples so far."""
        sums = _Sums(*state[:-2].tolist())
        sums.level += by
        return np.array([*vars(sums).values(), *state[-2:].tolist()])

    def _move(self, sums: _Sums, seconds: float, decay: float, weight: float, value: float) -> tuple[float, ...]:
        sums.pass_time(seconds, decay, self.MERGE)
        if isfinite(value):
            self._take(sums, seconds, weight, value)
        return tuple(vars(sums).values())

    def _take(self, sums: _Sums, seconds: float, weight: float, value: float) -> None:
        if seconds > GAP:
            sums.level = value
        difference = value - sums.level
        if abs(difference) <= self.threshold:
            sums.level += weight * difference
            return
        sums.quiet = 0.0
        if sums.above > self.LASTING:
            # A shock may have moved the level: it then stands out from the new one too.
            if abs(sums.peak - difference) <= self.threshold:
                sums.set_peak(0.0)
            sums.level = value
        elif abs(difference) > abs(sums.peak):
            sums.set_peak(difference)
