"""Whether innovations are as large as the calibration says."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.kalman.quiet import sum_in_order

Array = NDArray[np.float64]

LANES = 64
"""Sums that take turns: each in order, which for a single one takes longer than the filter."""


@dataclass
class Consistency:
    """Sum of the normalised innovations squared of the samples while the gate was closed, and how many were in both.

    The mean (NIS; Bar-Shalom et al. 2001, section 5.4) is 1 where the noise is what the calibration says.
    """

    closed: int = 0
    open: int = 0
    _lanes: list[float] = field(default_factory=lambda: [0.0] * LANES)

    @property
    def squares(self) -> float:
        """The sum."""
        return sum_in_order(self._lanes)

    def take(self, normalised: float) -> None:
        """Take one innovation over its standard deviation, the gate being closed."""
        self._lanes[self.closed % LANES] += normalised * normalised
        self.closed += 1

    def take_all(self, normalised: Array) -> None:
        """Take innovations (n,) as one by one."""
        first = LANES + self.closed % LANES
        last = first + len(normalised)
        rows = np.zeros((-(-last // LANES), LANES))
        rows[0] = self._lanes
        np.multiply(normalised, normalised, out=rows.reshape(-1)[first:last])
        # Row upon row: numpy sums in pairs along the last axis only.
        self._lanes = np.add.reduce(rows, axis=0).tolist()
        self.closed += len(normalised)
