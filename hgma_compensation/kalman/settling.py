"""The variance of the random-walk filter at an even interval, in closed form: many steps at once, each by itself.

The Riccati recursion V ← R (V + Q) / (V + Q + R) is a fractional linear map with a stable fixed point P and another
one, -B. A step multiplies (V - P) / (V + B) by (1 - K)², K the settled gain: V after k steps is a formula of k.
"""

from math import ceil, log, log1p, sqrt

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

AHEAD = 256
"""Steps computed together for a stream of single samples."""

LAST_BIT = 54.0 * log(2.0)
"""Time constants of the variance after which no bit of it is left to move."""

STANDING = 64.0 * float(np.finfo(np.float64).eps)
"""Share of the limit within which the recursion has come to stand still, beside the limit by what it has rounded."""

SMALLEST_RATIO, LARGEST_RATIO = 1e-24, 1e24
"""Of Q to R, between which the closed form is computed without loss: gains above 1e-12."""


class Settling:
    """Variances after 1, 2, ... further steps of equal Q and R from a known one.

    Each rounded operation is monotone in the number of steps: the variance moves in one direction, and cannot cycle.
    """

    def __init__(self, variance: float, added: float, sample_variance: float) -> None:
        """Take the variance before, Q and R; use ``can_tell`` before."""
        root = sqrt(added * (added + 4.0 * sample_variance))
        self.limit = 2.0 * added * sample_variance / (added + root)
        if abs(variance - self.limit) <= STANDING * self.limit:
            self.limit = variance
        other = self.limit + added
        self._sum, self._scale = root, variance + other
        self._product = root * (variance - self.limit)
        self._rate = 2.0 * log1p(other / sample_variance)
        self._steps = 1 if variance == self.limit else ceil(LAST_BIT / self._rate)
        self._first = 1
        self._ahead: list[float] = []

    def has_settled(self, steps: int) -> bool:
        """Return whether the variance is the limit from so many steps on."""
        return steps >= self._steps

    def between(self, first: int, last: int) -> Array:
        """Return the variances after ``first`` to ``last`` - 1 steps."""
        moving = max(min(last, self._steps) - first, 0)
        variances = np.empty(last - first)
        variances[moving:] = self.limit
        growth = np.expm1(self._rate * np.arange(first, first + moving, dtype=np.float64))
        growth *= self._scale
        growth += self._sum
        np.divide(self._product, growth, out=growth)
        np.add(self.limit, growth, out=variances[:moving])
        return variances

    def after(self, steps: int) -> float:
        """Return the variance after so many steps; fast when asked step by step."""
        if steps >= self._steps:
            return self.limit
        place = steps - self._first
        if not 0 <= place < len(self._ahead):
            place, self._first, self._ahead = 0, steps, self.between(steps, steps + AHEAD).tolist()
        return self._ahead[place]


def can_tell(added: float, sample_variance: float) -> bool:
    """Return whether the closed form holds for Q and R; where not, every step is one of the recursion."""
    return SMALLEST_RATIO * sample_variance <= added <= LARGEST_RATIO * sample_variance
