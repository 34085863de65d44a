"""The variance over consecutive samples of one interval: by recursion at first, then in closed form."""

from itertools import repeat

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.kalman.riccati import riccati
from hgma_compensation.kalman.settling import Settling, can_tell

Array = NDArray[np.float64]

DIRECT = 64
"""Steps by recursion before the closed form: shorter stretches are not worth its coefficients."""


class Stretch:
    """Samples with the same Q and R, taken one after the other; knows how many, and the variance from step to step."""

    def __init__(self, added: float, sample_variance: float) -> None:
        """Begin one with Q and R."""
        self.added, self.sample_variance = added, sample_variance
        self.count = 0
        self._settling: Settling | None = None

    @property
    def has_settled(self) -> bool:
        """Whether the variance after the last sample stays."""
        return self._settling is not None and self._settling.has_settled(self.count - DIRECT)

    def step(self, variance: float) -> float:
        """Take one more sample, after which the recursion says ``variance``; return what counts."""
        self.count += 1
        if self._settling is not None:
            return self._settling.after(self.count - DIRECT)
        if self.count == DIRECT:
            self._settle(variance)
        return variance

    def variances(self, variance: float, count: int) -> Array:
        """Return the variance before and after each of so many more samples, (count + 1,); take none of them."""
        direct = max(DIRECT - self.count, 0) if can_tell(self.added, self.sample_variance) else count
        direct = min(direct, count)
        variances = np.empty(count + 1)
        variances[: direct + 1] = riccati(variance, repeat(self.added, direct), repeat(self.sample_variance, direct))
        if direct < count:
            settling = self._settling or Settling(float(variances[direct]), self.added, self.sample_variance)
            first = self.count + direct + 1 - DIRECT
            variances[direct + 1 :] = settling.between(first, first + count - direct)
        return variances

    def take(self, variances: Array) -> None:
        """Take n samples, before the first and after each of which the variance is as ``variances`` said, (n + 1,)."""
        before, self.count = self.count, self.count + len(variances) - 1
        if self._settling is None and before < DIRECT <= self.count:
            self._settle(float(variances[DIRECT - before]))

    def take_settled(self, count: int) -> None:
        """Take so many samples while the variance stays at its limit."""
        self.count += count

    def _settle(self, variance: float) -> None:
        if can_tell(self.added, self.sample_variance):
            self._settling = Settling(variance, self.added, self.sample_variance)
