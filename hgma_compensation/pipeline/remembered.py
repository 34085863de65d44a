"""Samples of a slow input, kept so that a calibration that is swapped in knows the past."""

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice

from hgma_compensation.stamps import NANOSECONDS
from hgma_compensation.temperature.updates import POWER_OFF

REMEMBERED = 4096
"""Samples that are kept as they came: an hour at 1 Hz. As many older ones are kept thinned."""

THINNED = 30 * NANOSECONDS
"""Least time between older samples: 34 hours of them, and no memory takes such a pause for a lack of power."""

Pair = tuple[int, float]


@dataclass(frozen=True)
class History:
    """What was remembered at one moment: samples, oldest first, and the stamp of the power-on before them, ns.

    beginnings, taken: how often all had been forgotten by then, and how many samples had come since.
    """

    samples: tuple[Pair, ...]
    power_on: int | None
    beginnings: int
    taken: int


class Remembered:
    """The recent samples (ns, value) as they came, and before them one in THINNED."""

    def __init__(self) -> None:
        """Start empty."""
        self._recent: deque[Pair] = deque(maxlen=REMEMBERED)
        self._older: deque[Pair] = deque(maxlen=REMEMBERED)
        self.power_on: int | None = None
        self._beginnings = self._taken = 0

    def __iter__(self) -> Iterator[Pair]:
        """Yield the samples, oldest first; ``power_on`` is the stamp of the power-on before them, ns."""
        yield from self._older
        yield from self._recent

    def clear(self) -> None:
        """Forget all samples."""
        self._recent.clear()
        self._older.clear()
        self.power_on = None
        self._beginnings, self._taken = self._beginnings + 1, 0

    def history(self) -> History:
        """Return what is remembered now."""
        return History(tuple(self), self.power_on, self._beginnings, self._taken)

    def follows(self, history: History) -> bool:
        """Return whether all that came after a history is still there, and nothing was forgotten in between."""
        return self._beginnings == history.beginnings and self._taken - history.taken <= len(self._recent)

    def since(self, history: History) -> Iterator[Pair]:
        """Yield the samples that came after a history which these follow."""
        return islice(self._recent, len(self._recent) - (self._taken - history.taken), None)

    def add(self, stamp: int, value: float) -> None:
        """Keep a sample."""
        if self.power_on is None:
            self.power_on = stamp
        if len(self._recent) == REMEMBERED:
            self._thin(self._recent[0], self._recent[1][0])
        self._recent.append((stamp, value))
        self._taken += 1

    def _thin(self, sample: Pair, following: int) -> None:
        """Keep one of the older samples, unless it is close to the one before; always that before a power-off."""
        older = self._older
        if older and sample[0] - older[-1][0] < THINNED and following - sample[0] <= POWER_OFF:
            return
        if len(older) == REMEMBERED and older[1][0] - older[0][0] > POWER_OFF:
            self.power_on = older[1][0]
        older.append(sample)
