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
    # Soon after the beginning, or after a step ahead, it means something else.
    "clock set back": (
        "acceleration_clock_set_back",
        "acceleration_time_jumped_back",
        "acceleration_clock_was_ahead",
    ),
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
        for begin in np.arange(0.0, seconds, SECONDS).tolist():
            blocks = bool(self.random.random() < BLOCKS)
            items = clean_segment(begin, self.rate, self.random, blocks=blocks)
            hurt: set[str] = set()
            for _ in range(int(self.random.integers(3))):
                name = self._choose([name for name in (*FAULTS, *CLOCKS) if self._fits(name, blocks)], hurt)
                hurt.add(_victim(name))
                self.faults[name] += 1
                items = self._hurt(items, name, begin)
            yield self._numbered(items)

    def _choose(self, names: list[str], hurt: set[str]) -> str:
        """Return one of the faults that have come least often, and hurt nothing that is hurt already."""
        left = [name for name in names if _victim(name) not in hurt]
        least = min(self.faults[name] for name in left)
        return str(self.random.choice([name for name in left if self.faults[name] == least]))

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
