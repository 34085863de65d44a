"""Tells real acceleration from noise: by sums of innovations, and by the quiet that follows.

A single sample's innovation shows a shock that stands above the noise at once; sums over 4, 16 and 64
samples show slower and weaker motion, down to an eighth of the noise of a sample.
"""

from collections import deque
from math import sqrt

SCALES = (1, 4, 16, 64)
WINDOW = SCALES[-1]
"""Samples that the longest sum covers."""

QUIET_BLOCKS = 3
"""Blocks of WINDOW samples that must agree before the gate closes."""


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
    """Watches samples while the gate is open, for three blocks in a row that hold nothing but noise."""

    def __init__(self, threshold: float) -> None:
        """Use ``threshold`` standard deviations as the gate does."""
        self._threshold = threshold
        self.reset()

    def reset(self) -> None:
        """Begin a new wait."""
        self._block: list[float] = []
        self._means: list[float] = []

    def mean_when_quiet(self, sample: float, deviation: float) -> float | None:
        """Take a sample and its noise's standard deviation.

        Return the mean of the last QUIET_BLOCKS blocks once no sample in them stands out of its block and
        no two blocks differ by more than their noise, else None.
        """
        self._block.append(sample)
        if len(self._block) < WINDOW:
            return None
        mean = sum(self._block) / WINDOW
        calm = max(abs(value - mean) for value in self._block) <= self._threshold * deviation
        self._block = []
        tolerance = self._threshold * deviation * sqrt(2.0 / WINDOW)
        if not calm or any(abs(mean - other) > tolerance for other in self._means):
            self._means = []
        if calm:
            self._means.append(mean)
        if len(self._means) < QUIET_BLOCKS:
            return None
        level = sum(self._means) / QUIET_BLOCKS
        self.reset()
        return level
