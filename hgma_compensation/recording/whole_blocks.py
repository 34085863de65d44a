"""Blocks of a bag that are taken as wholes, as the node takes them.

The same bits as block by block and sample by sample, without an array of float64 for a window.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import cast

import numpy as np

from hgma_compensation.cdr.block import BlockLayout
from hgma_compensation.cdr.header import read_stamp
from hgma_compensation.channels import AXES
from hgma_compensation.pipeline.live_result import BlockEnd
from hgma_compensation.pipeline.ordinary_block import OrdinaryBlocks, offsets_of
from hgma_compensation.pipeline.pipeline import Pipeline
from hgma_compensation.recording.accelerations import STAMP_AT, STAMP_SIZE, BlockMessages, of_rows
from hgma_compensation.recording.batch import Batch, Indices
from hgma_compensation.recording.compensation import Ends, Layout


@dataclass
class WholeBlocks:
    """Blocks of one frame that were compensated: the messages that are written, and their last samples.

    inside: of each, whether the features of all its samples lie in the calibrated range.
    """

    layout: BlockLayout
    times: list[int] = field(default_factory=list)
    messages: list[bytearray] = field(default_factory=list)
    last: list[BlockEnd] = field(default_factory=list)
    inside: list[bool] = field(default_factory=list)

    @property
    def compensated(self) -> int:
        """Number of samples."""
        return len(self.messages) * self.layout.count

    @property
    def outside_range(self) -> int:
        """Number of samples whose features lie outside of the calibrated range."""
        return self.inside.count(False) * self.layout.count

    def outputs(self, channels: Sequence[str]) -> Batch:
        """Return the compensated messages as topic 0."""
        # They are written now, which reads either sort of bytes; a copy of each would cost as much as its drift.
        return Batch.of_messages([0] * len(self.messages), self.times, cast(list[bytes], self.messages))

    def ends(self) -> Ends:
        """Return what decides which of the messages get a state."""
        stamps = np.array([end.stamp for end in self.last], dtype=np.int64)
        status = np.array([end.cell.status for end in self.last], dtype=np.uint8)
        return Ends(stamps, status, np.array(self.inside, dtype=np.bool_))

    def states(self, chosen: Indices, layout: Layout) -> Iterator[Batch]:
        """Yield the states of the last samples of the messages ``chosen`` (m,), increasing, as topic 0."""
        rows = chosen.tolist()
        if rows:
            stamps = b"".join(self.messages[row][STAMP_AT : STAMP_AT + STAMP_SIZE] for row in rows)
            heads = np.frombuffer(stamps, dtype=np.uint8).reshape(len(rows), STAMP_SIZE)
            last = [self.last[row] for row in rows]
            stamped = np.array([end.stamp for end in last], dtype=np.int64)
            left = np.array([end.left for end in last])
            result = last[0].pipeline.ends_of_blocks(stamped, [end.cell for end in last], left)
            states = layout(self.layout.frame).rows(heads, result)
            yield of_rows(states, np.array([self.times[row] for row in rows], dtype=np.int64))


class WholeBlockReader:
    """Takes the blocks of a bag through a pipeline as long as they are laid out alike and nothing happens in them.

    not_zero: (3,) whether an axis of a block that was taken is anywhere other than 0.
    """

    def __init__(self, pipeline: Pipeline) -> None:
        """Begin before any block."""
        self._pipeline = pipeline
        self._blocks = OrdinaryBlocks()
        self._layout: BlockLayout | None = None
        self.not_zero = np.zeros(len(AXES), dtype=np.bool_)

    def learn(self, messages: BlockMessages) -> None:
        """Take blocks laid out like the last of some that were looked at sample by sample."""
        view = messages.last_view
        if view is None:
            self._layout = None
        elif self._layout is None or not self._layout.holds(view.raw):
            self._layout = BlockLayout(view)

    def take(self, batch: Batch) -> WholeBlocks | None:
        """Return the blocks from the first of a batch to the last that can be taken as a whole, None for none."""
        calibrated = self._pipeline.columns.axes
        if self._layout is None or calibrated is None:
            return None
        made = WholeBlocks(self._layout)
        for row, time in enumerate(batch.times.tolist()):
            if not self._take(batch.raw(row), time, calibrated, made):
                break
        return made if made.messages else None

    def _take(self, raw: memoryview, time: int, calibrated: slice, made: WholeBlocks) -> bool:
        """Compensate one block; return False where it must be looked at sample by sample."""
        layout = made.layout
        if not layout.holds(raw):
            return False
        stamp, offsets = read_stamp(raw), offsets_of(layout.count, layout.sample_interval)
        last = stamp + offsets.last
        cells = self._pipeline.uniform_cells(stamp, last) if offsets.plain else None
        if cells is None or len({cell.inside for cell in cells}) > 1:
            return False
        message = bytearray(raw)
        # Of the copy, which lies where numbers should lie; a message may lie anywhere in its chunk.
        axes = layout.axes(message)
        if not self.not_zero.all():
            self.not_zero |= axes.any(axis=1)
        sums = self._blocks.take(stamp, offsets, axes[calibrated], cells, axes[calibrated])
        if sums is None:
            return False
        self._pipeline.go_on_through(last)
        made.times.append(time)
        made.messages.append(message)
        made.last.append(BlockEnd(self._pipeline, last, cells[-1], sums.last))
        made.inside.append(cells[-1].inside)
        return True
