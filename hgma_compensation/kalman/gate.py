"""Tells real acceleration from noise by sums of innovations.

A single sample's innovation shows a shock that stands above the noise at once; sums over 4, 16 and 64
samples show slower and weaker motion, down to an eighth of the noise of a sample.
"""

from collections import deque

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.kalman.random_walk import Number

SCALES = (1, 4, 16, 64)

WINDOW = SCALES[-1]
"""Samples that the longest sum covers."""


class InnovationGate:
    """Sums of normalised innovations; at rest white with variance 1, on a level that may wander.

    A sum over L samples is the difference of two running totals, a single one is taken as it is.
    """

    def __init__(self, threshold: float, wander: float) -> None:
        """Open beyond ``threshold`` standard deviations of any sum; wander as in FilterSettings."""
        self._threshold, self._wander = threshold * threshold, wander * wander
        self.reset()

    def reset(self) -> None:
        """Forget all innovations."""
        self._totals = deque([0.0] * WINDOW, maxlen=WINDOW)
        self._variance, self._limits = 0.0, [0.0] * len(SCALES)

    def _limits_at(self, variance: Number) -> list[Number]:
        """Return what the squares of sums may be: their white part has the variance L, the wander L² times its own."""
        wander = self._wander / variance
        return [self._threshold * (scale + wander * (scale * scale)) for scale in SCALES]

    def exceeded(self, normalised: float, variance: float) -> bool:
        """Take an innovation over its standard deviation, and its variance; return whether a sum is above its limit."""
        if variance != self._variance:
            self._variance, self._limits = variance, self._limits_at(variance)
        totals = self._totals
        total = totals[-1] + normalised
        beyond = False
        for scale, limit in zip(SCALES, self._limits, strict=True):
            part = total - totals[-scale] if scale > 1 else normalised
            if not part * part <= limit:
                beyond = True
        totals.append(total)
        return beyond

    def take_until_exceeded(self, normalised: NDArray[np.float64], variance: float | NDArray[np.float64]) -> int:
        """Take innovations (n,) up to, without it, the first that exceeds; return how many: as ``exceeded`` does.

        variance: (n,), or one for all.
        """
        totals = np.concatenate([self._totals, normalised])
        totals[WINDOW - 1 :] = np.add.accumulate(totals[WINDOW - 1 :])
        within = np.ones(len(normalised), dtype=np.bool_)
        for scale, limit in zip(SCALES, self._limits_at(np.asarray(variance)), strict=True):
            sums = totals[WINDOW:] - totals[WINDOW - scale : -scale] if scale > 1 else normalised
            within &= sums * sums <= limit
        count = len(within) if within.all() else int(np.argmin(within))
        self._totals.extend(totals[count : count + WINDOW].tolist())
        return count
