"""Tells real acceleration from noise by sums of innovations.

A single sample's innovation shows a shock that stands above the noise at once; sums over 4, 16 and 64
samples show slower and weaker motion, down to an eighth of the noise of a sample.
"""

from collections import deque
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.kalman.random_walk import Number

SCALES = (1, 4, 16, 64)

WINDOW = SCALES[-1]
"""Samples that the longest sum covers."""

HALVES = ((1, 2), (4, 8), (16, 32))
"""Samples of the sums of which two make the next, on the way from one of SCALES to the next."""

Array = NDArray[np.float64]


class InnovationGate:
    """Sums of normalised innovations; at rest white with variance 1, on a level that may wander.

    A sum over 2 L samples is the one over the last L and the one L samples before, so that of an innovation nothing is
    left in any sum once the sample has left the window.
    """

    def __init__(self, threshold: float, wander: float) -> None:
        """Open beyond ``threshold`` standard deviations of any sum; wander as in FilterSettings."""
        self._threshold, self._wander = threshold * threshold, wander * wander
        self.reset()

    def reset(self) -> None:
        """Forget all innovations."""
        self._delayed = [(_zeros(single), _zeros(double)) for single, double in HALVES]
        self._variance, self._limits = 0.0, [0.0] * len(SCALES)

    def _limits_at(self, variance: Number) -> list[Number]:
        """Return what the squares of sums may be: their white part has the variance L, the wander L² times its own."""
        wander = self._wander / variance
        return [self._threshold * (scale + wander * (scale * scale)) for scale in SCALES]

    def _limits_of(self, variance: float | Array) -> Sequence[float | Array]:
        """Return the same of one variance or many; of one where there is no wander, which none of them changes."""
        if isinstance(variance, float):
            return self._limits_at(variance)
        return self._limits_at(variance) if self._wander else self._limits_at(1.0)

    def exceeded(self, normalised: float, variance: float) -> bool:
        """Take an innovation over its standard deviation, and its variance; return whether a sum is above its limit."""
        if variance != self._variance:
            self._variance, self._limits = variance, self._limits_at(variance)
        beyond = not normalised * normalised <= self._limits[0]
        part = normalised
        for (first, second), limit in zip(self._delayed, self._limits[1:], strict=True):
            double = first[0] + part
            first.append(part)
            part = second[0] + double
            second.append(double)
            if not part * part <= limit:
                beyond = True
        return beyond

    def take_until_exceeded(self, normalised: Array, variance: float | Array) -> int:
        """Take innovations (n,) up to, without it, the first that exceeds; return how many: as ``exceeded`` does.

        variance: (n,), or one for all.
        """
        count = len(normalised)
        if not count:
            return 0
        limits = self._limits_of(variance)
        within = leading_within(normalised, limits[0])
        parts, newest = normalised, []
        for pair, limit in zip(self._delayed, limits[1:], strict=True):
            for delayed in pair:
                length = len(delayed)
                history = np.empty(length + count)
                history[:length], history[length:] = delayed, parts
                newest.append((delayed, history[count:].tolist()))
                parts = history[:count] + history[length:]
            within = min(within, leading_within(parts, limit))
        if within < count:  # taken without the rest, none of which is noted yet
            every = variance if isinstance(variance, float) else variance[:within]
            return self.take_until_exceeded(normalised[:within], every)
        for delayed, values in newest:
            delayed.extend(values)
        return count


def _zeros(length: int) -> deque[float]:
    return deque([0.0] * length, maxlen=length)


def leading_within(sums: Array, limit: float | Array) -> int:
    """Return how many of the sums (n,), n > 0, come before the first whose square exceeds the limit, (n,) or one."""
    # Squares are monotone after rounding: where those of the extremes are within, all are. NaN never is.
    least = limit if isinstance(limit, float) else float(np.minimum.reduce(limit))
    lowest, highest = float(np.minimum.reduce(sums)), float(np.maximum.reduce(sums))
    if lowest * lowest <= least and highest * highest <= least:
        return len(sums)
    within = sums * sums <= limit
    return len(sums) if within.all() else int(np.argmin(within))
