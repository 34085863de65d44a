"""Tells real acceleration from noise: by sums of innovations, and by the quiet that follows.

A single sample's innovation shows a shock that stands above the noise at once; sums over 4, 16 and 64
samples show slower and weaker motion, down to an eighth of the noise of a sample.
"""

from collections import deque
from math import sqrt

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
