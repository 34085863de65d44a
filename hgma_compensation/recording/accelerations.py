"""Accelerometer messages of a bag in bulk: samples out of them, compensated copies made of them.

What ``hgma_compensation.cdr`` does not recognise becomes a message object; the results are the same.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.cdr.block import BlockView
from hgma_compensation.cdr.imu import ImuBatch, batches
from hgma_compensation.channels import AXES, CHANNELS, GROUPS
from hgma_compensation.messages import (
    absent_groups,
    block_samples,
    check_block,
    imu_values,
    patch_block,
    patch_covariances,
    patch_imu,
    stamp_of,
)
from hgma_compensation.pipeline.compensated import Compensated
from hgma_compensation.pipeline.ordinary_block import offsets_of
from hgma_compensation.recording import typestore as types
from hgma_compensation.recording.batch import Batch, Indices, joined, windows
from hgma_compensation.stamps import Stamps

Array = NDArray[np.float64]
Decode = Callable[[bytes], Any]
"""Returns the message object of a serialised message."""

STAMP_AT, STAMP_SIZE = 4, 8
"""Place and bytes of a header's stamp in a serialised message."""


class ImuMessages:
    """Imu messages, one sample in each.

    stamps: (n,) ns. values: (n, 6), columns CHANNELS. counts: (n,) samples in each message, 1. carried: the fields
    that not every message declares absent.
    """

    def __init__(self, batch: Batch, decode: Decode) -> None:
        """Take the messages of a batch."""
        self._batch = batch
        self._pieces = list(_imu_pieces(batch, decode))
        self.stamps: Stamps = np.empty(len(batch), dtype=np.int64)
        self.values: Array = np.empty((len(batch), len(CHANNELS)))
        self.counts: Indices = np.ones(len(batch), dtype=np.int64)
        self.carried: set[str] = set()
        for rows, piece in self._pieces:
            if isinstance(piece, ImuBatch):
                self.stamps[rows], self.values[rows] = piece.stamps, piece.values
                self.carried |= {group for group in GROUPS if not piece.absent(group).all()}
            else:
                self.stamps[rows], self.values[rows] = stamp_of(piece), imu_values(piece)
                self.carried |= set(GROUPS) - absent_groups(piece)

    def frames(self, rows: Indices) -> list[tuple[slice, str]]:
        """Return the frame of each run of the messages ``rows`` (m,), increasing; the slices are of these."""
        return _frames(self._pieces, rows)

    def heads(self, rows: Indices) -> NDArray[np.uint8]:
        """Return the stamps of messages as serialised, (m, 8)."""
        return _heads(self._batch, self._pieces, rows)

    def compensated(self, channels: Sequence[str], rows: Indices, result: Compensated) -> Batch:
        """Return copies of the messages ``rows`` (m,), increasing, with the result for them put in."""
        made = []
        variances = None
        if not result.ordinary:
            variances = np.where(result.status[:, None] > 0, result.uncertainty**2, np.nan)
        for span, piece in self._pieces:
            part = slice(*np.searchsorted(rows, (span.start, span.stop)).tolist())
            if part.start == part.stop:
                continue
            if isinstance(piece, ImuBatch):
                own = rows[part] - span.start
                patched = piece.patched(
                    own, channels, result.values[part], None if variances is None else variances[part]
                )
                made.append(of_rows(patched, self._batch.times[rows[part]]))
            else:
                patch_imu(piece, channels, result.values[part.start].tolist())
                patch_covariances(piece, channels, result.added_variance(part.start))
                made.append(_of_message(piece, types.IMU, int(self._batch.times[span.start])))
        return joined(made)


class BlockMessages:
    """AccelBlocks, many samples in each.

    stamps: (n,) ns. values: (n, 6), columns CHANNELS, no angular rate. counts: (k,) samples in each message.
    """

    carried = frozenset(GROUPS[:1])

    def __init__(self, batch: Batch, decode: Decode, source: str) -> None:
        """Take the messages of a batch; raises RefusedError, naming the source, for one that is none."""
        self._batch = batch
        self._blocks = [_block(batch, row, decode) for row in range(len(batch))]
        self._pieces = [(slice(row, row + 1), block) for row, block in enumerate(self._blocks)]
        for block in self._blocks:
            check_block(block, source)
        self.counts: Indices = np.array([len(block.x) for block in self._blocks], dtype=np.int64)
        self.stamps: Stamps = np.empty(int(self.counts.sum()), dtype=np.int64)
        # Channel by channel, as the blocks hold them and the pipeline's drift comes.
        self.values: Array = np.zeros((len(CHANNELS), len(self.stamps))).T
        for block, rows in zip(self._blocks, self.samples(), strict=True):
            if isinstance(block, BlockView):
                np.add(offsets_of(len(block.x), block.sample_interval).stamps, block.stamp, out=self.stamps[rows])
                for column, axis in enumerate(AXES):
                    self.values[rows, column] = getattr(block, axis)
            else:
                self.stamps[rows], self.values[rows, : len(AXES)] = block_samples(block, source)

    @property
    def last_view(self) -> BlockView | None:
        """The last of the messages, None where its layout is not recognised."""
        last = self._blocks[-1]
        return last if isinstance(last, BlockView) else None

    def samples(self) -> list[slice]:
        """Return the samples of each message."""
        ends = np.cumsum(self.counts)
        return [slice(a, b) for a, b in zip((ends - self.counts).tolist(), ends.tolist(), strict=True)]

    def frames(self, rows: Indices) -> list[tuple[slice, str]]:
        """Return the frame of each run of the messages ``rows`` (m,), increasing; the slices are of these."""
        return _frames(self._pieces, rows)

    def heads(self, rows: Indices) -> NDArray[np.uint8]:
        """Return the stamps of messages as serialised, (m, 8)."""
        return _heads(self._batch, self._pieces, rows)

    def compensated(self, channels: Sequence[str], rows: Indices, result: Compensated) -> Batch:
        """Return copies of the messages ``rows`` (m,), increasing, with the result for their samples put in."""
        columns = {channel[-1]: n for n, channel in enumerate(channels) if channel.startswith(GROUPS[0])}
        raws, done = [], 0
        for row in rows.tolist():
            block, count = self._blocks[row], int(self.counts[row])
            values, done = result.values[done : done + count], done + count
            if isinstance(block, BlockView):
                raws.append(block.patched({axis: values[:, n].astype(np.float32) for axis, n in columns.items()}))
            else:
                patch_block(block, channels, values)
                raws.append(bytes(types.typestore().serialize_cdr(block, types.ACCEL_BLOCK)))
        return Batch.of_messages([0] * len(raws), self._batch.times[rows].tolist(), raws)


def _imu_pieces(batch: Batch, decode: Decode) -> Iterator[tuple[slice, ImuBatch | Any]]:
    """Yield consecutive messages of one layout, or one message that is none of a known one."""
    for same in batch.same_sizes():
        start = int(same[0])
        some = batch.select(slice(start, start + len(same)))
        whole = ImuBatch.of_rows(some.rows())
        if whole is not None:
            yield slice(start, start + len(same)), whole
            continue
        raws = some.raws()
        for span, piece in batches(raws):
            rows = slice(start + span.start, start + span.stop)
            yield rows, decode(raws[span.start]) if piece is None else piece


def _block(batch: Batch, row: int, decode: Decode) -> BlockView | Any:
    view = BlockView.of(batch.raw(row))
    return decode(bytes(batch.raw(row))) if view is None else view


def _frames(pieces: Sequence[tuple[slice, Any]], rows: Indices) -> list[tuple[slice, str]]:
    found: list[tuple[slice, str]] = []
    stops = np.searchsorted(rows, [span.stop for span, _ in pieces]).tolist()
    start = 0
    for (_, piece), stop in zip(pieces, stops, strict=True):
        if start == stop:
            continue
        frame = piece.frame if isinstance(piece, (ImuBatch, BlockView)) else str(piece.header.frame_id)
        if found and found[-1][1] == frame:
            found[-1] = slice(found[-1][0].start, stop), frame
        else:
            found.append((slice(start, stop), frame))
        start = stop
    return found


def _heads(batch: Batch, pieces: Sequence[tuple[slice, Any]], rows: Indices) -> NDArray[np.uint8]:
    chosen = batch.select(rows)
    if chosen.apart is None:
        heads = windows(chosen.memory, STAMP_SIZE)[chosen.starts + STAMP_AT]
    else:  # blocks, which would all be copied to lie together
        stamps = bytearray().join(raw[STAMP_AT : STAMP_AT + STAMP_SIZE] for raw in chosen.apart)
        heads = np.frombuffer(stamps, dtype=np.uint8).reshape(len(rows), STAMP_SIZE)
    for span, piece in pieces:
        if not isinstance(piece, (ImuBatch, BlockView)):
            stamp = piece.header.stamp
            own = struct.pack("<iI", stamp.sec, stamp.nanosec)
            heads[(rows >= span.start) & (rows < span.stop)] = np.frombuffer(own, dtype=np.uint8)
    return heads


def of_rows(rows: NDArray[np.uint8], times: Stamps) -> Batch:
    """Return messages (m, size) as a batch of topic 0."""
    count, size = rows.shape
    starts = np.arange(count, dtype=np.int64) * size
    return Batch(np.zeros(count, dtype=np.int64), times, rows.reshape(-1), starts, np.full(count, size))


def _of_message(message: Any, message_type: str, time: int) -> Batch:
    return Batch.of_messages([0], [time], [bytes(types.typestore().serialize_cdr(message, message_type))])
