"""The Kalman stage sample by sample, each formula as the paper writes it: what the stage in bulk is held to."""

from collections import deque
from dataclasses import dataclass
from math import sqrt

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.kalman.random_walk import RandomWalkNoise
from hgma_compensation.kalman.settings import FilterMode, FilterSettings
from hgma_compensation.stamps import Stamps, seconds_between


class RandomWalkFilter:
    """One channel's estimate and its variance, moved by the caller from sample to sample."""

    def __init__(self, noise: RandomWalkNoise) -> None:
        """Start without a sample."""
        self._white, self._walk = noise.white * noise.white, noise.walk * noise.walk
        self.reset()

    def reset(self) -> None:
        """Forget every sample."""
        self.started = False
        self.estimate = 0.0
        self.variance: float | None = None

    def start(self, estimate: float, variance: float | None = None) -> None:
        """Begin at an estimate; without a variance it is a sample whose own interval is unknown."""
        self.started, self.estimate, self.variance = True, estimate, variance

    def sample_variance(self, dt: float) -> float:
        """Return R of a sample that averages over dt (s)."""
        return self._white / dt

    def predict(self, dt: float, averaged: float | None = None) -> float:
        """Let dt (s, > 0) pass and return the variance of the innovation to come: Eqs. (7), (8).

        The level is predicted unchanged. A first sample of unknown interval is given the noise of the
        second. averaged: s that the sample averages over, where that is not dt.
        """
        sample_variance = self._white / (dt if averaged is None else averaged)
        self.variance = (sample_variance if self.variance is None else self.variance) + self._walk * dt
        return self.variance + sample_variance

    def correct(self, innovation: float, innovation_variance: float) -> None:
        """Take the measurement in: Eqs. (9) to (11)."""
        assert self.variance is not None
        gain = self.variance / innovation_variance  # Eq. (9)
        self.estimate += gain * innovation  # Eq. (10)
        self.variance = (1.0 - gain) * self.variance  # Eq. (11)


SCALES = (1, 4, 16, 64)
WINDOW = SCALES[-1]
"""Samples that the longest sum covers."""

RETURN_BLOCKS, NEW_LEVEL_BLOCKS = 3, 16
"""Calm blocks of WINDOW samples after which a known level is believed again, and a new one for the first time."""

AGREEMENT = 3.0
"""Standard deviations of their noise within which two levels count as the same."""


class InnovationGate:
    """Sums of normalised innovations; at rest white with variance 1, on a level that may wander."""

    def __init__(self, threshold: float, wander: float) -> None:
        """Open beyond ``threshold`` standard deviations of any sum; wander as in FilterSettings."""
        self._threshold, self._wander = threshold * threshold, wander * wander
        self.reset()

    def reset(self) -> None:
        """Forget all innovations."""
        self._recent = deque([0.0] * WINDOW, maxlen=WINDOW)
        self._sums = [0.0] * len(SCALES)

    def exceeded(self, innovation: float, variance: float) -> bool:
        """Take one innovation and its variance; return whether any sum is beyond its limit.

        The white part of a sum over L samples has the variance L, the wander of the level L² times its own.
        """
        recent, sums = self._recent, self._sums
        normalised, wander = innovation / sqrt(variance), self._wander / variance
        beyond = False
        for k, scale in enumerate(SCALES):
            sums[k] += normalised - recent[-scale]
            if not sums[k] * sums[k] <= self._threshold * (scale + wander * scale * scale):
                beyond = True
        recent.append(normalised)
        return beyond


class QuietDetector:
    """Watches samples while the gate is open, for blocks of WINDOW samples that hold nothing but noise."""

    def __init__(self, threshold: float, wander: float) -> None:
        """Use ``threshold`` standard deviations and the wander of the level as the gate does."""
        self._threshold, self._wander = threshold, wander * wander
        self.reset()

    def reset(self) -> None:
        """Begin a new wait."""
        self._block: list[float] = []
        self._means: list[float] = []

    def block_ends(self, sample: float, deviation: float) -> bool:
        """Take a sample and its noise's standard deviation; return whether it completed a calm block.

        A block with a sample that stands out of it, or one that differs from the block before by more than
        their noise, begins the wait anew.
        """
        self._block.append(sample)
        if len(self._block) < WINDOW:
            return False
        block, self._block = self._block, []
        mean = sum(block) / WINDOW
        if max(abs(value - mean) for value in block) > self._threshold * deviation:
            self._means = []
            return False
        tolerance = self._threshold * self.deviation_of_mean(WINDOW, deviation) * sqrt(2.0)
        if self._means and abs(mean - self._means[-1]) > tolerance:
            self._means = []
        self._means = [*self._means, mean][-NEW_LEVEL_BLOCKS:]
        return True

    def deviation_of_mean(self, count: int, deviation: float) -> float:
        """Return the standard deviation of a mean over ``count`` samples about a level that wanders."""
        return sqrt(deviation * deviation / count + self._wander)

    def recent_level(self) -> float | None:
        """Return the mean of the last RETURN_BLOCKS calm blocks, None before there are so many."""
        if len(self._means) < RETURN_BLOCKS:
            return None
        return sum(self._means[-RETURN_BLOCKS:]) / RETURN_BLOCKS

    def steady_level(self, deviation: float) -> float | None:
        """Return the mean of NEW_LEVEL_BLOCKS calm blocks whose halves agree, None otherwise."""
        if len(self._means) < NEW_LEVEL_BLOCKS:
            return None
        half = NEW_LEVEL_BLOCKS // 2
        early, late = sum(self._means[:half]) / half, sum(self._means[half:]) / half
        if abs(late - early) > AGREEMENT * self.deviation_of_mean(half * WINDOW, deviation) * sqrt(2.0):
            return None
        return 0.5 * (early + late)


LOOK_BACK = 1024
"""Samples before an opening whose integral is made good."""

INSTALMENTS = 192
"""Parts in which it is: as many samples as the gate needs to close at the least."""

CALM = 3.0
"""Standard deviations: instalments are paid on samples within this of the level, never near a peak."""


class ImpulseDebt:
    """Withheld velocity, in the channel's unit times s."""

    def __init__(self) -> None:
        """Owe nothing."""
        self.reset()

    def reset(self) -> None:
        """Forget what is owed."""
        self._withheld: deque[float] = deque(maxlen=LOOK_BACK)
        self._owed = self._instalment = 0.0

    def withhold(self, impulse: float) -> None:
        """Note what one sample's output lacks: (input - output) · dt."""
        self._withheld.append(impulse)

    def call_in(self) -> None:
        """The gate has opened: owe what the samples before it lack."""
        self._owed += sum(self._withheld)
        self._instalment = abs(self._owed) / INSTALMENTS
        self._withheld.clear()

    def pay(self, dt: float, normalised: float) -> float:
        """Return what to add to the output of a sample of length dt (s), whose innovation is ``normalised``."""
        if self._owed == 0.0 or not -CALM <= normalised <= CALM:
            return 0.0
        impulse = min(max(self._owed, -self._instalment), self._instalment)
        # The last instalment is what is left, so the debt ends at exactly nothing.
        self._owed -= impulse
        return impulse / dt


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
