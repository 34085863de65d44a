"""Which recordings are learned from, and which is held out."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.diagnosis.blocks import Blocks
from hgma_compensation.recording.filed import FiledRecording
from hgma_compensation.recording.recording import Recording, Series
from hgma_compensation.recording.sliced import Column, Sampled, Sliced, in_parts, one_after_the_other
from hgma_compensation.recording.spooled import AT_ONCE, Spooled
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

    recordings: tuple[Sampled, ...]
    held: tuple[int, int]
    holdout: str

    def held_out(self, stamps: Stamps, recording: Sampled) -> "NDArray[np.bool_]":
        """Return for stamps (n,) of a recording whether they belong to the hold-out."""
        if f"+{self.holdout}+" not in f"+{recording.name}+":  # it may be joined to others, and have a + itself
            return np.zeros(len(stamps), dtype=bool)
        return np.asarray((stamps >= self.held[0]) & (stamps <= self.held[1]))

    def share_held(self, recording: Sampled) -> float:
        """Return the share of a recording's samples that belong to the hold-out."""
        parts = in_parts(recording.samples, AT_ONCE)
        held = sum(int(self.held_out(recording.stamps[part], recording).sum()) for part in parts)
        return held / recording.samples

    def held_rows(self, blocks: Blocks) -> "NDArray[np.bool_]":
        """Return for each block whether it belongs to the hold-out."""
        rows = np.zeros(len(blocks), dtype=bool)
        for number, recording in enumerate(self.recordings):
            mine = blocks.run == number
            rows[mine] = self.held_out(blocks.stamps[mine], recording)
        return rows


def arrange(recordings: Sequence[Sampled], holdout: Sampled | None) -> Material:
    """Return what to learn from and what to judge on.

    Without a hold-out it is the last recording, or the end of the only one.
    """
    ordered = sorted(recordings, key=lambda recording: recording.start)
    if holdout is None and len(ordered) > 1:
        holdout = ordered.pop()
    if holdout is None:
        first, last = ordered[0].first, ordered[0].last
        return Material(tuple(ordered), (last - int(HELD_OUT * (last - first)), last), ordered[0].name)
    named = _named(holdout, f"{holdout.name} (hold-out)") if any(r.name == holdout.name for r in ordered) else holdout
    held = (named.first, named.last)
    return Material(tuple(_joined(sorted([*ordered, named], key=lambda r: r.start))), held, named.name)


def _named(recording: Sampled, name: str) -> Sampled:
    assert isinstance(recording, Recording | FiledRecording)
    return replace(recording, name=name)


def _joined(ordered: Sequence[Sampled]) -> list[Sampled]:
    joined = [ordered[0]]
    for recording in ordered[1:]:
        last = joined[-1]
        pause = (recording.start - last.last) / NANOSECONDS
        if 0.0 < pause <= CONTINUED and recording.frame == last.frame and recording.present == last.present:
            joined[-1] = _join(last, recording)
        else:
            joined.append(recording)
    return joined


def _join(first: Sampled, second: Sampled) -> FiledRecording:
    def both(name: str) -> Series:
        a, b = getattr(first, name), getattr(second, name)
        return Series(np.concatenate([a.stamps, b.stamps]), np.concatenate([a.values, b.values]))

    return FiledRecording(
        name=f"{first.name}+{second.name}",
        stamps=one_after_the_other([first.stamps, second.stamps]),
        values=one_after_the_other([first.values, second.values]),
        present=first.present,
        temperature=both("temperature"),
        temperature_2=both("temperature_2"),
        supply_voltage=both("supply_voltage"),
        frame=first.frame,
        block=_join_blocks(first, second),
        first=min(first.first, second.first),
        last=max(first.last, second.last),
    )


def _join_blocks(first: Sampled, second: Sampled) -> Sliced | None:
    """Return the numbers of the blocks that samples came in, each of single messages a block of its own."""
    if first.block is None and second.block is None:
        return None
    numbers, begin = Spooled(1, np.int64), 0
    for recording in (first, second):
        for part in in_parts(recording.samples, AT_ONCE):
            own = np.arange(part.start, part.stop) if recording.block is None else recording.block[part]
            numbers.add((begin + own)[:, None])
        begin = int(numbers[-1:][0, 0]) + 1
    return Column(numbers, 0)
