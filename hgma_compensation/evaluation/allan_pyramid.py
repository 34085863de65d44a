"""Allan deviation of a series that is too long to be held: estimated while it goes by.

Averages over m = j·2^k samples are formed of means over 2^k, which overlap in steps of 2^k, a small part of m (the
overlapping estimator of allantools steps by one sample). Up to m = 11 the estimate is the overlapping one itself;
beyond, it differs by a fraction of its own uncertainty.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

FIRST = (1, 2, 3, 4, 6, 8, 11)
"""Averaging factors on the samples themselves."""

FURTHER = (8, 11)
"""Averaging factors on the means over 2^k samples: two to the octave."""

REACH = 2 * max(FIRST)
"""Values before a new one that a difference reaches back to."""


class AllanPyramid:
    """Follows c evenly spaced series of equal length."""

    def __init__(self, width: int) -> None:
        """Start without samples of ``width`` series."""
        self._levels: list[_Level] = []
        self._width = width
        self.samples = 0

    def add(self, values: Array) -> None:
        """Take samples (n, c), many at a time: few cost as much."""
        self.samples += len(values)
        number = 0
        while len(values):
            if number == len(self._levels):
                self._levels.append(_Level(FURTHER if number else FIRST, self._width))
            values = self._levels[number].add(values)
            number += 1

    def deviations(self, longest: int) -> tuple[NDArray[np.int64], Array]:
        """Return averaging factors (k,) up to ``longest``, increasing, and the Allan deviations (k, c) at them."""
        found = {
            factor << number: np.sqrt(level.squares[factor] / (2.0 * factor * factor * level.counts[factor]))
            for number, level in enumerate(self._levels)
            for factor in level.factors
            if level.counts[factor] and factor << number <= longest
        }
        factors = sorted(found)
        return np.array(factors, dtype=np.int64), np.array([found[factor] for factor in factors])


@dataclass
class _Level:
    """Means over 2^k samples. squares: (c,) sums of squared differences of each factor. counts: of these."""

    factors: tuple[int, ...]
    width: int
    squares: dict[int, Array] = field(init=False)
    counts: dict[int, int] = field(init=False)

    def __post_init__(self) -> None:
        self.squares = {factor: np.zeros(self.width) for factor in self.factors}
        self.counts = dict.fromkeys(self.factors, 0)
        self._before = self._odd = np.empty((0, self.width))
        self._origin: Array | None = None

    def add(self, values: Array) -> Array:
        """Take values (n, c) and return those of the next level."""
        if self._origin is None:
            self._origin = values[0].copy()
        # A constant is nothing to differences of sums, and without it the sums are small.
        near = np.concatenate([self._before, values - self._origin])
        sums = np.concatenate([np.zeros((1, self.width)), np.cumsum(near, axis=0)])
        for factor in self.factors:
            terms = min(len(values), len(near) - 2 * factor + 1)
            if terms > 0:
                late, middle, early = (sums[len(sums) - terms - back :][:terms] for back in (0, factor, 2 * factor))
                difference = late - 2.0 * middle + early
                self.squares[factor] += np.sum(difference * difference, axis=0)
                self.counts[factor] += terms
        self._before = near[-REACH:]
        pairs = np.concatenate([self._odd, values])
        whole = len(pairs) // 2 * 2
        self._odd = pairs[whole:]
        return np.asarray(0.5 * (pairs[0:whole:2] + pairs[1:whole:2]))
