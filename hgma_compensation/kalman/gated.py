"""The Kalman stage of one channel, one sample at a time: random-walk filter, gate, and the two ways of using them."""

from collections import deque
from math import sqrt

from hgma_compensation.kalman.consistency import Consistency
from hgma_compensation.kalman.gate import WINDOW, InnovationGate
from hgma_compensation.kalman.impulse import ImpulseDebt
from hgma_compensation.kalman.quiet import QuietDetector
from hgma_compensation.kalman.random_walk import Number, RandomWalkFilter
from hgma_compensation.kalman.settings import FilterMode, FilterSettings


class GatedFilter:
    """Filter and gate, with the state that gated_bulk.py moves on over many samples at once.

    Closed, the filter follows the level. When the gate opens, the filter returns to where it was before
    the gate's window began, and stays there; the output is the input until quiet has returned. SMOOTH then
    goes on at the level found, BIAS only if that is the one from before: a new level is real acceleration
    to it, not bias.
    """

    def __init__(self, settings: FilterSettings, reference: float) -> None:
        """Take the settings of a channel whose mode is not OFF, and its still value (BIAS: bias = 0 there)."""
        assert settings.noise is not None
        self.level = RandomWalkFilter(settings.noise)
        self.is_bias = settings.mode is FilterMode.BIAS
        self._reference, self._initial = reference, settings.initial_bias**2
        self.gate = InnovationGate(settings.threshold, settings.wander)
        self.quiet = QuietDetector(settings.threshold, settings.wander)
        self.debt = ImpulseDebt()
        self.openings = 0
        self.consistency = Consistency()
        self.reset()

    def reset(self) -> None:
        """Forget every sample; the number of openings stays."""
        self.level.reset()
        self.gate.reset()
        self.quiet.reset()
        self.debt.reset()
        self.history: deque[tuple[float, float | None]] = deque(maxlen=WINDOW)
        self.open = False

    def start(self, first: float) -> None:
        """Begin under the first sample."""
        if self.is_bias:
            self.level.start(self._reference, self._initial)
        else:
            self.level.start(first)

    def step(self, dt: float, averaged: float, z: float) -> tuple[float, float]:
        """Take a sample that comes dt (s) after the one before and averages over s; return output and innovation.

        One with dt = 0 has no known noise: it passes under the estimate there is, and corrects nothing.
        """
        level = self.level
        innovation = z - level.estimate
        if dt <= 0.0:
            return self.output(z, level.estimate), innovation
        before = (level.estimate, level.variance)
        sample_variance = level.sample_variance(averaged)
        innovation_variance = level.predict(dt, sample_variance)
        normalised = innovation / sqrt(innovation_variance)
        if self.open:
            self.consistency.open += 1
            output = self.output(z, level.estimate)
            if self.quiet.block_ends(z, sample_variance):
                self.close_if_quiet(sample_variance)
        elif self.gate.exceeded(normalised, innovation_variance):
            self._open(before)
            output = self.output(z, level.estimate)
        else:
            self.history.append(before)
            self.consistency.take(normalised)
            level.correct(z, sample_variance)
            output = self.output(z, level.estimate)
            self.debt.withhold((z - output) * dt)
        return (output + self.debt.pay(dt, normalised) if self.debt.owes else output), innovation

    def output(self, z: Number, estimate: Number) -> Number:
        """Return what comes out for samples under the estimates after them."""
        if self.is_bias:
            return z - (estimate - self._reference)
        return z if self.open else estimate

    def _open(self, before: tuple[float, float | None]) -> None:
        """Undo what the gate's window did to the estimate: its samples belong to what opened the gate."""
        self.open = True
        self.openings += 1
        estimate, variance = self.history[0] if self.history else before
        self.level.start(estimate, variance if variance is not None else self.level.variance)
        self.history.clear()
        self.quiet.reset()
        if not self.is_bias:
            self.debt.call_in()

    def close_if_quiet(self, sample_variance: float) -> bool:
        """Close the gate once the level from before has returned, or (SMOOTH) another one is steady."""
        level = self.level
        assert level.variance is not None
        if not self.quiet.has_returned(level.estimate, level.variance, sample_variance):
            steady = None if self.is_bias else self.quiet.steady_level(sample_variance)
            if steady is None:
                return False
            level.start(*steady)
        self.open = False
        self.gate.reset()
        return True
