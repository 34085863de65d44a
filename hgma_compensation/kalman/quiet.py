"""Finds the quiet that follows real acceleration, and the level that it is at."""

from collections.abc import Sequence
from functools import reduce
from math import sqrt
from operator import add

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.kalman.gate import WINDOW

RETURN_BLOCKS, NEW_LEVEL_BLOCKS = 3, 16
"""Calm blocks of WINDOW samples after which a known level is believed again, and a new one for the first time."""

AGREEMENT = 3.0
"""Standard deviations of their noise within which two levels count as the same."""


def sum_in_order(values: Sequence[float]) -> float:
    """Return the sum of one or more numbers, one by one: sum() compensates its rounding from Python 3.12 on."""
    return reduce(add, values)


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

    def block_ends(self, sample: float, sample_variance: float) -> bool:
        """Take a sample and the variance of its noise; return whether it completed a calm block."""
        self._block.append(sample)
        if len(self._block) < WINDOW:
            return False
        block, self._block = self._block, []
        mean = sum_in_order(block) / WINDOW
        return self.take_block(mean, max(abs(value - mean) for value in block), sample_variance)

    def blocks(self, samples: NDArray[np.float64]) -> list[tuple[int, float, float]]:
        """Take samples (n,); return for each block that they complete how many it took, its mean and its spread.

        Each is to be given to ``take_block``, as long as the wait goes on.
        """
        values = np.concatenate([self._block, samples])
        rows = values[: len(values) - len(values) % WINDOW].reshape(-1, WINDOW)
        means = np.add.accumulate(rows, axis=1)[:, -1] / WINDOW
        spreads = np.abs(rows - means[:, None]).max(axis=1)
        taken = WINDOW * np.arange(1, len(rows) + 1) - len(self._block)
        self._block = values[rows.size :].tolist()
        return list(zip(taken.tolist(), means.tolist(), spreads.tolist(), strict=True))

    def take_block(self, mean: float, spread: float, sample_variance: float) -> bool:
        """Take a block's mean and the largest difference from it; return whether it is calm.

        A block with a sample that stands out of it, or one that differs from the block before by more than
        their noise, begins the wait anew.
        """
        deviation = sqrt(sample_variance)
        if spread > self._threshold * deviation:
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

    def has_returned(self, level: float, variance: float, sample_variance: float) -> bool:
        """Return whether the last RETURN_BLOCKS calm blocks are at a level that is known with a variance."""
        if len(self._means) < RETURN_BLOCKS:
            return False
        mean_deviation = self.deviation_of_mean(RETURN_BLOCKS * WINDOW, sqrt(sample_variance))
        recent = sum_in_order(self._means[-RETURN_BLOCKS:]) / RETURN_BLOCKS
        return abs(recent - level) <= AGREEMENT * sqrt(variance + mean_deviation * mean_deviation)

    def steady_level(self, sample_variance: float) -> tuple[float, float] | None:
        """Return mean and variance of NEW_LEVEL_BLOCKS calm blocks whose halves agree, None otherwise."""
        if len(self._means) < NEW_LEVEL_BLOCKS:
            return None
        half = NEW_LEVEL_BLOCKS // 2
        early, late = sum_in_order(self._means[:half]) / half, sum_in_order(self._means[half:]) / half
        if abs(late - early) > AGREEMENT * self.deviation_of_mean(half * WINDOW, sqrt(sample_variance)) * sqrt(2.0):
            return None
        return 0.5 * (early + late), sample_variance / (NEW_LEVEL_BLOCKS * WINDOW)
