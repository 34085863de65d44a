"""Memories of the temperature that are stepped through a run, and on to the next one."""

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.diagnosis.runs import power_ons
from hgma_compensation.diagnosis.smoothing import Smoothed
from hgma_compensation.effects.memory import Bank
from hgma_compensation.stamps import NANOSECONDS, Stamps

Array = NDArray[np.float64]

MEMORY_STEP = 3.0
"""s between the temperatures that memories are told: between them it is as good as straight."""


def enough(stamps: Stamps) -> NDArray[np.int64]:
    """Return the indices of samples about MEMORY_STEP apart, those at the edges of pauses and the last included."""
    interval = float(np.median(np.diff(stamps))) if len(stamps) > 1 else NANOSECONDS
    stride = max(1, int(MEMORY_STEP * NANOSECONDS / interval + 1e-6))
    starts = power_ons(stamps)
    return np.unique(np.concatenate([np.arange(0, len(stamps), stride), starts, starts[1:] - 1, [len(stamps) - 1]]))


class Ends:
    """Where memories stood at the end of the run before."""

    def __init__(self, bank: Bank, limits: tuple[float, float]) -> None:
        """Take memories that are told temperatures inside the limits, °C."""
        self._bank, self._limits = bank, limits
        self._last: tuple[int, Array, Array] | None = None

    def start(self, run: Smoothed) -> Array:
        """Return the state (1, m) at the start of a run: that of the last one, the pause gone by."""
        first = np.clip(run.temperature[:1], *self._limits)
        if self._last is None or run.stamps[0] <= self._last[0]:
            return self._bank.start(first)[None]
        pause = np.array([[(int(run.stamps[0]) - self._last[0]) * 1e-9]])
        return self._bank.advance(self._last[1], pause, self._last[2], first[None])

    @property
    def last(self) -> Array:
        """The state (m,) that was kept last."""
        assert self._last is not None
        return self._last[1][0]

    def keep(self, run: Smoothed, state: Array) -> None:
        """Remember the state (1, m) at the end of a run."""
        self._last = (int(run.stamps[-1]), state, np.clip(run.temperature[-1:, None], *self._limits))
