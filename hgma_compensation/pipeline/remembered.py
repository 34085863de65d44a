"""Samples of a slow input, kept so that a calibration that is swapped in knows the past."""

from collections import deque
from collections.abc import Iterable, Iterator

from hgma_compensation.stamps import NANOSECONDS
from hgma_compensation.temperature.updates import POWER_OFF

REMEMBERED = 4096
"""Samples that are kept as they came: an hour at 1 Hz. As many older ones are kept thinned."""

THINNED = 30 * NANOSECONDS
"""Least time between older samples: 34 hours of them, and no memory takes such a pause for a lack of power."""

Pair = tuple[int, float]


class Remembered:
    """The recent samples (ns, value) as they came, and before them one in THINNED."""

    def __init__(self) -> None:
        """Start empty."""
        self._recent: deque[Pair] = deque(maxlen=REMEMBERED)
        self._older: deque[Pair] = deque(maxlen=REMEMBERED)
        self.power_on: int | None = None

    def __iter__(self) -> Iterator[Pair]:
        """Yield the samples, oldest first; ``power_on`` is the stamp of the power-on before them, ns."""
        yield from self._older
        yield from self._recent

    @classmethod
    def of(cls, power_on: int | None, samples: Iterable[Pair]) -> "Remembered":
        """Return what is remembered of samples after a power-on at a stamp in ns, None for that of the first."""
        remembered = cls()
        remembered.power_on = power_on
        for stamp, value in samples:
            remembered.add(stamp, value)
        return remembered

    @property
    def newest(self) -> int | None:
        """Stamp of the sample that came last, ns."""
        return self._recent[-1][0] if self._recent else None

    def copy(self) -> "Remembered":
        """Return what is remembered now; it is not changed by samples that come later."""
        twin = Remembered()
        twin._recent, twin._older, twin.power_on = self._recent.copy(), self._older.copy(), self.power_on
        return twin

    def clear(self) -> None:
        """Forget all samples."""
        self._recent.clear()
        self._older.clear()
        self.power_on = None

    def add(self, stamp: int, value: float) -> None:
        """Keep a sample."""
        if self.power_on is None:
            self.power_on = stamp
        if len(self._recent) == REMEMBERED:
            self._thin(self._recent[0], self._recent[1][0])
        self._recent.append((stamp, value))

    def _thin(self, sample: Pair, following: int) -> None:
        """Keep one of the older samples, unless it is close to the one before; always that before a power-off."""
        older = self._older
        if older and sample[0] - older[-1][0] < THINNED and following - sample[0] <= POWER_OFF:
            return
        if len(older) == REMEMBERED and older[1][0] - older[0][0] > POWER_OFF:
            self.power_on = older[1][0]
        older.append(sample)
