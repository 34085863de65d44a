"""What came from a node within a while, summed up."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.channels import CHANNELS

Array = NDArray[np.float64]


@dataclass
class Samples:
    """Sums over samples of CHANNELS, from which their mean and deviation follow.

    Deviations are summed about the first sample, because a drift of thousands of m/s² would swallow the digits.
    """

    count: int = 0
    _origin: Array | None = None
    _sum: Array = field(default_factory=lambda: np.zeros(len(CHANNELS)))
    _squares: Array = field(default_factory=lambda: np.zeros(len(CHANNELS)))

    def add(self, values: Array) -> None:
        """Add samples (n, 6), in the order of CHANNELS; what is not finite is left out with its whole sample."""
        values = values[np.isfinite(values).all(axis=1)]
        if not len(values):
            return
        if self._origin is None:
            self._origin = values[0].copy()
        away = values - self._origin
        self.count += len(values)
        self._sum += away.sum(axis=0)
        self._squares += (away**2).sum(axis=0)

    @property
    def mean(self) -> Array | None:
        """Return the means (6,), None without samples."""
        return None if self._origin is None else self._origin + self._sum / self.count

    @property
    def deviation(self) -> Array | None:
        """Return the standard deviations (6,), None with fewer than two samples."""
        if self.count < 2:
            return None
        variance = (self._squares - self._sum**2 / self.count) / (self.count - 1)
        return np.asarray(np.sqrt(np.maximum(variance, 0.0)))


@dataclass
class Window:
    """raw, compensated: samples of both topics. states: how many came; state: the last one, a CompensationState.

    condition: level and message of the node's last diagnostics.
    """

    raw: Samples = field(default_factory=Samples)
    compensated: Samples = field(default_factory=Samples)
    states: int = 0
    state: Any = None
    condition: tuple[int, str] | None = None

    def next(self) -> "Window":
        """Return the window after this one, which knows what stays true."""
        return Window(state=self.state, condition=self.condition)
