"""Samples of a slow input, kept so that a calibration that is swapped in knows the past."""

from array import array
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import chain

from hgma_compensation.pipeline.sample_ring import Pair, SampleRing
from hgma_compensation.stamps import NANOSECONDS
from hgma_compensation.temperature.updates import POWER_OFF

REMEMBERED = 4096
"""Samples that are kept as they came: an hour at 1 Hz. As many older ones are kept thinned."""

THINNED = 30 * NANOSECONDS
"""Least time between older samples: 34 hours of them, and no memory takes such a pause for a lack of power."""


@dataclass(frozen=True)
class History:
    """What was remembered at one moment: stamps (ns) and values, oldest first, and the stamp of the power-on before.

    beginnings, taken: how often all had been forgotten by then, and how many samples had come since.
    """

    stamps: "array[int]"
    values: "array[float]"
    power_on: int | None
    beginnings: int
    taken: int

    @property
    def samples(self) -> Iterator[Pair]:
        """The samples, oldest first."""
        return zip(self.stamps, self.values, strict=True)


class Remembered:
    """The recent samples (ns, value) as they came, and before them one in THINNED."""

    def __init__(self) -> None:
        """Start empty."""
        self._recent, self._older = SampleRing(REMEMBERED), SampleRing(REMEMBERED)
        self.power_on: int | None = None
        self._beginnings = self._taken = 0

    def __iter__(self) -> Iterator[Pair]:
        """Yield the samples, oldest first; ``power_on`` is the stamp of the power-on before them, ns."""
        return chain(self._older, self._recent)

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
        twin.begin_with(self)
        return twin

    def begin_with(self, other: "Remembered") -> None:
        """Remember what another one does, and nothing else; no history that was taken before is followed any more."""
        self.clear()
        self._recent.copy_from(other._recent)
        self._older.copy_from(other._older)
        self.power_on = other.power_on

    def clear(self) -> None:
        """Forget all samples."""
        self._recent.clear()
        self._older.clear()
        self.power_on = None
        self._beginnings, self._taken = self._beginnings + 1, 0

    def history(self) -> History:
        """Return what is remembered now."""
        older, recent = self._older.newest(len(self._older)), self._recent.newest(len(self._recent))
        return History(older[0] + recent[0], older[1] + recent[1], self.power_on, self._beginnings, self._taken)

    def follows(self, history: History) -> bool:
        """Return whether all that came after a history is still there, and nothing was forgotten in between."""
        return self._beginnings == history.beginnings and self._taken - history.taken <= len(self._recent)

    def since(self, history: History) -> Iterator[Pair]:
        """Return the samples that came after a history which these follow."""
        return zip(*self._recent.newest(self._taken - history.taken), strict=True)

    def add(self, stamp: int, value: float) -> None:
        """Keep a sample."""
        if self.power_on is None:
            self.power_on = stamp
        if self._recent.full:
            self._thin(self._recent[0], self._recent[1][0])
        self._recent.append(stamp, value)
        self._taken += 1

    def _thin(self, sample: Pair, following: int) -> None:
        """Keep one of the older samples, unless it is close to the one before; always that before a power-off."""
        older = self._older
        if older and sample[0] - older[-1][0] < THINNED and following - sample[0] <= POWER_OFF:
            return
        if older.full and older[1][0] - older[0][0] > POWER_OFF:
            self.power_on = older[1][0]
        older.append(*sample)
