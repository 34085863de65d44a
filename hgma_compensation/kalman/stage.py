"""The Kalman stage of one channel: random-walk filter, gate, and the two ways of using them."""

from collections import deque
from dataclasses import dataclass
from math import sqrt

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.kalman.gate import (
    AGREEMENT,
    NEW_LEVEL_BLOCKS,
    RETURN_BLOCKS,
    WINDOW,
    InnovationGate,
    QuietDetector,
)
from hgma_compensation.kalman.impulse import ImpulseDebt
from hgma_compensation.kalman.random_walk import RandomWalkFilter
from hgma_compensation.kalman.settings import FilterMode, FilterSettings
from hgma_compensation.stamps import Stamps, seconds_between

PAUSE = 10.0
"""Times the interval before: a longer one is a pause, in which the level went on and no sample was taken."""


@dataclass
class Consistency:
    """Sum of the normalised innovations squared of the samples while the gate was closed, and how many were in both.

    The mean (NIS; Bar-Shalom et al. 2001, section 5.4) is 1 where the noise is what the calibration says.
    """

    squares: float = 0.0
    closed: int = 0
    open: int = 0


class KalmanStage:
    """Streaming stage; a batch runs through the same steps.

    Closed, the filter follows the level. When the gate opens, the filter returns to where it was before
    the gate's window began, and stays there; the output is the input until quiet has returned. SMOOTH then
    goes on at the level found, BIAS only if that is the one from before: a new level is real acceleration
    to it, not bias.
    """

    def __init__(self, settings: FilterSettings, reference: float) -> None:
        """Take the settings of a channel whose mode is not OFF, and its still value (BIAS: bias = 0 there)."""
        assert settings.noise is not None
        self._level = RandomWalkFilter(settings.noise)
        self._bias = settings.mode is FilterMode.BIAS
        self._reference, self._initial = reference, settings.initial_bias**2
        self._gate = InnovationGate(settings.threshold, settings.wander)
        self._quiet = QuietDetector(settings.threshold, settings.wander)
        self._debt = ImpulseDebt()
        self.openings = 0
        self._consistency = Consistency()
        self.reset()

    def reset(self) -> None:
        """Forget every sample; the number of openings stays."""
        self._level.reset()
        self._gate.reset()
        self._quiet.reset()
        self._debt.reset()
        self._history: deque[tuple[float, float | None]] = deque(maxlen=WINDOW)
        self.open = False
        self._newest = 0
        self._interval = 0.0

    def set_back(self, stamp: int) -> None:
        """Go on at a clock that was set back, the next sample's being ``stamp`` (ns): that one has no interval."""
        self._newest = stamp

    def take_consistency(self) -> Consistency:
        """Return what the innovations were like since the last call."""
        taken, self._consistency = self._consistency, Consistency()
        return taken

    def run(self, stamps: Stamps, measured: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return outputs and innovations, each (n,), of finite measurements (n,) at stamps (ns).

        A sample whose stamp does not exceed all before it has no interval, hence no known noise: it passes
        under the estimate there is, and corrects nothing.
        """
        if not len(stamps):
            return np.empty(0), np.empty(0)
        if not self._level.started:
            self._newest = int(stamps[0])
            self._start(float(measured[0]))
        newest = np.maximum.accumulate(np.concatenate([[self._newest], stamps]))
        steps = seconds_between(stamps, newest[:-1]).tolist()
        outputs, innovations = np.empty(len(stamps)), np.empty(len(stamps))
        for k, (dt, z) in enumerate(zip(steps, measured.tolist(), strict=True)):
            outputs[k], innovations[k] = self._step(dt, z)
        self._newest = int(newest[-1])
        return outputs, innovations

    def _start(self, first: float) -> None:
        if self._bias:
            self._level.start(self._reference, self._initial)
        else:
            self._level.start(first)

    def _step(self, dt: float, z: float) -> tuple[float, float]:
        level = self._level
        innovation = z - level.estimate
        if dt <= 0.0:
            return self._output(z), innovation
        before = (level.estimate, level.variance)
        innovation_variance = level.predict(dt, self._averaged(dt))
        normalised = innovation / sqrt(innovation_variance)
        if self.open:
            self._consistency.open += 1
            output = self._output(z)
            self._wait_for_quiet(z, self._interval)
        elif self._gate.exceeded(innovation, innovation_variance):
            self._open(before)
            output = self._output(z)
        else:
            self._history.append(before)
            self._consistency.squares += normalised * normalised
            self._consistency.closed += 1
            level.correct(innovation, innovation_variance)
            output = self._output(z)
            self._debt.withhold((z - output) * dt)
        return output + self._debt.pay(dt, normalised), innovation

    def _averaged(self, dt: float) -> float:
        """Return the time (s) that a sample averages over which comes dt after the one before: no pause belongs to it.

        Moves on to another sampling rate within a few samples.
        """
        longest = PAUSE * self._interval
        self._interval = dt if longest == 0.0 or dt <= longest else longest
        return self._interval

    def _output(self, z: float) -> float:
        if self._bias:
            return z - (self._level.estimate - self._reference)
        return z if self.open else self._level.estimate

    def _open(self, before: tuple[float, float | None]) -> None:
        """Undo what the gate's window did to the estimate: its samples belong to what opened the gate."""
        self.open = True
        self.openings += 1
        estimate, variance = self._history[0] if self._history else before
        self._level.start(estimate, variance if variance is not None else self._level.variance)
        self._history.clear()
        self._quiet.reset()
        if not self._bias:
            self._debt.call_in()

    def _wait_for_quiet(self, z: float, dt: float) -> None:
        """Close the gate once the level from before has returned, or (SMOOTH) another one is steady."""
        level = self._level
        assert level.variance is not None
        deviation = sqrt(level.sample_variance(dt))
        if not self._quiet.block_ends(z, deviation):
            return
        recent = self._quiet.recent_level()
        mean_deviation = self._quiet.deviation_of_mean(RETURN_BLOCKS * WINDOW, deviation)
        tolerance = AGREEMENT * sqrt(level.variance + mean_deviation**2)
        returned = recent is not None and abs(recent - level.estimate) <= tolerance
        if not returned:
            steady = None if self._bias else self._quiet.steady_level(deviation)
            if steady is None:
                return
            level.start(steady, deviation**2 / (NEW_LEVEL_BLOCKS * WINDOW))
        self.open = False
        self._gate.reset()
