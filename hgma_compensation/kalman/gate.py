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
    """Sums of normalised innovations; white with variance 1 while the filter's model holds."""

    def __init__(self, threshold: float) -> None:
        """Open beyond ``threshold`` standard deviations of any sum (dimensionless)."""
        self._limits = [threshold * sqrt(scale) for scale in SCALES]
        self.reset()

    def reset(self) -> None:
        """Forget all innovations."""
        self._recent = deque([0.0] * WINDOW, maxlen=WINDOW)
        self._sums = [0.0] * len(SCALES)

    def exceeded(self, normalised: float) -> bool:
        """Take one innovation over its standard deviation; return whether any sum is beyond its limit."""
        recent, sums = self._recent, self._sums
        beyond = False
        for k, scale in enumerate(SCALES):
            sums[k] += normalised - recent[-scale]
            if not -self._limits[k] <= sums[k] <= self._limits[k]:
                beyond = True
        recent.append(normalised)
        return beyond


class QuietDetector:
    """Watches samples while the gate is open, for blocks of WINDOW samples that hold nothing but noise."""

    def __init__(self, threshold: float) -> None:
        """Use ``threshold`` standard deviations as the gate does."""
        self._threshold = threshold
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
        tolerance = self._threshold * deviation
        if max(abs(value - mean) for value in block) > tolerance:
            self._means = []
            return False
        if self._means and abs(mean - self._means[-1]) > tolerance * sqrt(2.0 / WINDOW):
            self._means = []
        self._means = [*self._means, mean][-NEW_LEVEL_BLOCKS:]
        return True

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
        if abs(late - early) > AGREEMENT * deviation * sqrt(2.0 / (half * WINDOW)):
            return None
        return 0.5 * (early + late)
