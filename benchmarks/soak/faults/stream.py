"""The whole stream, segment after segment, with its clock and its faults."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from benchmarks.soak.faults.kinds import FAULTS, Fault
from benchmarks.soak.faults.segment import SECONDS, Action, Item, Sample, clean_segment
from hgma_compensation.stamps import to_nanoseconds

BLOCKS = 0.1
"""Fraction of the segments that come in blocks."""

CLOCKS = {
    "bag loops": ("acceleration_time_jumped_back",),
    "clock set back": ("acceleration_clock_set_back",),
    "pause": ("acceleration_paused",),
}
"""What happens to the clock of all streams, with the counters that say so."""


@dataclass
class Stream:
    """Yields what is sent; faults: how often each kind was put in. rate: Hz of the messages."""

    random: np.random.Generator
    rate: float
    faults: Counter[str] = field(default_factory=Counter)
    _shift: float = 0.0
    _number: int = 0

    def segments(self, seconds: float) -> Iterator[list[Item]]:
        """Yield the segments of a stream of that length, each with one fault, or two, or none."""
        wanted: list[str] = []
        for begin in np.arange(0.0, seconds, SECONDS).tolist():
            blocks = bool(self.random.random() < BLOCKS)
            items = clean_segment(begin, self.rate, self.random, blocks=blocks)
            hurt: set[str] = set()
            for _ in range(int(self.random.integers(3))):
                # All kinds come before any comes again.
                wanted = wanted or self.random.permutation([*FAULTS, *CLOCKS]).tolist()
                name = next((name for name in wanted if self._fits(name, blocks) and _victim(name) not in hurt), None)
                if name is not None:
                    wanted.remove(name)
                    hurt.add(_victim(name))
                    self.faults[name] += 1
                    items = self._hurt(items, name, begin)
            yield self._numbered(items)

    def _fits(self, name: str, blocks: bool) -> bool:
        return name in CLOCKS or FAULTS[name].blocks in (None, blocks)

    def _hurt(self, items: list[Item], name: str, begin: float) -> list[Item]:
        fault: Fault | None = FAULTS.get(name)
        if fault is not None:
            return fault.apply(items, self.random)
        if name == "bag loops":
            self._shift = -begin
        elif name == "clock set back":
            self._shift -= float(self.random.uniform(6.0, 9.0))
        else:
            self._shift += float(self.random.uniform(70.0, 1000.0))
        return items

    def _numbered(self, items: list[Item]) -> list[Item]:
        shift = to_nanoseconds(self._shift)
        for item in items:
            if isinstance(item, Action):
                continue
            if item.stamp > 0:
                item.stamp = max(item.stamp + shift, 1)
            if isinstance(item, Sample):
                self._number += 1
                item.number = self._number
        return items


def _victim(name: str) -> str:
    """Return what a fault hurts: two faults of one sensor would hide each other."""
    return name.split()[0]
