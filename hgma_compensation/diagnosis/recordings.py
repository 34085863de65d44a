"""Which recordings are learned from, and which is held out."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.diagnosis.blocks import Blocks
from hgma_compensation.recording.recording import Recording, Series
from hgma_compensation.stamps import NANOSECONDS, Stamps

HELD_OUT = 0.25
"""Share of a single recording, at its end, that is held out where no other one is given."""

CONTINUED = 60.0
"""s: a recording that begins so soon after another one is its continuation: memories go on."""


@dataclass(frozen=True)
class Material:
    """recordings: in the order of their stamps, continued ones joined. held: (first, last) stamps of the hold-out.

    holdout: its name.
    """

    recordings: tuple[Recording, ...]
    held: tuple[int, int]
    holdout: str

    def held_out(self, stamps: Stamps, recording: Recording) -> "NDArray[np.bool_]":
        """Return for stamps (n,) of a recording whether they belong to the hold-out."""
        if f"+{self.holdout}+" not in f"+{recording.name}+":  # it may be joined to others, and have a + itself
            return np.zeros(len(stamps), dtype=bool)
        return np.asarray((stamps >= self.held[0]) & (stamps <= self.held[1]))

    def held_rows(self, blocks: Blocks) -> "NDArray[np.bool_]":
        """Return for each block whether it belongs to the hold-out."""
        rows = np.zeros(len(blocks), dtype=bool)
        for number, recording in enumerate(self.recordings):
            mine = blocks.run == number
            rows[mine] = self.held_out(blocks.stamps[mine], recording)
        return rows


def arrange(recordings: Sequence[Recording], holdout: Recording | None) -> Material:
    """Return what to learn from and what to judge on.

    Without a hold-out it is the last recording, or the end of the only one.
    """
    ordered = sorted(recordings, key=lambda recording: recording.start)
    if holdout is None and len(ordered) > 1:
        holdout = ordered.pop()
    if holdout is None:
        first, last = int(ordered[0].stamps.min()), int(ordered[0].stamps.max())
        return Material(tuple(ordered), (last - int(HELD_OUT * (last - first)), last), ordered[0].name)
    named = replace(
        holdout, name=f"{holdout.name} (hold-out)" if any(r.name == holdout.name for r in ordered) else holdout.name
    )
    held = (int(named.stamps.min()), int(named.stamps.max()))
    return Material(tuple(_joined(sorted([*ordered, named], key=lambda r: r.start))), held, named.name)


def _joined(ordered: Sequence[Recording]) -> list[Recording]:
    joined = [ordered[0]]
    for recording in ordered[1:]:
        last = joined[-1]
        pause = (recording.start - int(last.stamps.max())) / NANOSECONDS
        if 0.0 < pause <= CONTINUED and recording.frame == last.frame and recording.present == last.present:
            joined[-1] = _join(last, recording)
        else:
            joined.append(recording)
    return joined


def _join(first: Recording, second: Recording) -> Recording:
    def both(name: str) -> Series:
        a, b = getattr(first, name), getattr(second, name)
        return Series(np.concatenate([a.stamps, b.stamps]), np.concatenate([a.values, b.values]))

    return replace(
        first,
        name=f"{first.name}+{second.name}",
        stamps=np.concatenate([first.stamps, second.stamps]),
        values=np.concatenate([first.values, second.values]),
        temperature=both("temperature"),
        temperature_2=both("temperature_2"),
        supply_voltage=both("supply_voltage"),
    )
