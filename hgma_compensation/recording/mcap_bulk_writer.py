"""Writes an MCAP file as ``rosbags`` does, with the messages put into chunks many at a time."""

from __future__ import annotations

from collections import defaultdict, deque
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rosbags.interfaces import Connection
from rosbags.rosbag2 import CompressionMode
from rosbags.rosbag2 import storage_mcap as mcap

from hgma_compensation.recording.batch import Batch, Indices, windows
from hgma_compensation.recording.mcap_records import INDEX_ENTRY, MESSAGE, MESSAGE_HEAD, MESSAGE_INDEX, RECORD_HEAD

CHUNK = 1 << 20
"""Bytes of a chunk beyond which it is closed."""

_CHUNK = 0x06

LARGE = 2048
"""Bytes of a message from which on it is copied by itself: many at a time are copied twice."""


MOST_CLOSED = 2
"""Chunks that are compressed, by a thread, or wait to be while the next is filled."""


@dataclass(frozen=True)
class _Closed:
    """A chunk that is being compressed, with the entries of its message indexes."""

    chunk: mcap.PendingChunk
    entries: dict[int, list[NDArray[np.void]]]
    packed: Future[bytes]


class BulkMcapWriter(mcap.McapWriter):
    """Adds ``write_batch``; header, schemas, channels and summary are those of the library."""

    def __init__(self, path: Path, compression: CompressionMode) -> None:
        """Create the file."""
        super().__init__(path, compression)
        self._entries: dict[int, list[NDArray[np.void]]] = defaultdict(list)
        self._packer = ThreadPoolExecutor(1)
        self._closed: deque[_Closed] = deque()

    def write(self, connection: Connection, timestamp: int, data: bytes | memoryview) -> None:
        """Write a message at a log time in ns."""
        times = np.array([timestamp], dtype=np.int64)
        memory = np.frombuffer(data, dtype=np.uint8)
        here, sizes = np.zeros(1, dtype=np.int64), np.array([len(memory)], dtype=np.int64)
        self.write_batch(np.array([connection.id]), Batch(here, times, memory, here, sizes))

    def write_batch(self, channels: Indices, batch: Batch) -> None:
        """Write messages, of the connections whose ids are ``channels`` (n,)."""
        for number, count in zip(*np.unique(channels, return_counts=True), strict=True):
            self.channel_stats[int(number)] += int(count)
        ends = np.cumsum(batch.sizes + MESSAGE_HEAD.itemsize)
        row = done = 0
        while row < len(batch):
            # The message that makes a chunk too large is its last.
            room = CHUNK - self.chunk.bio.tell()
            stop = min(int(ends.searchsorted(done + room, side="right")) + 1, len(batch))
            self._put(channels[row:stop], batch.select(slice(row, stop)), ends[row:stop] - done)
            row, done = stop, int(ends[stop - 1])
            if self.chunk.bio.tell() > CHUNK:
                self.close_chunk()

    def _put(self, channels: Indices, batch: Batch, ends: Indices) -> None:
        """Append messages, whose records end at ``ends`` (n,) after what there is, to the chunk."""
        offset = self.chunk.bio.tell()
        starts = ends - batch.sizes - MESSAGE_HEAD.itemsize
        if int(ends[-1]) > LARGE * len(batch):
            self._append_each(channels, batch)
        else:
            self.chunk.bio.write(_records(channels, batch, starts, int(ends[-1])).data)
        first, last = int(batch.times.min()), int(batch.times.max())
        self.chunk.message_start_time = min(first, self.chunk.message_start_time)
        self.chunk.message_end_time = max(last, self.chunk.message_end_time)
        self.message_start_time = min(first, self.message_start_time)
        self.message_end_time = max(last, self.message_end_time)
        for channel in np.unique(channels).tolist():
            rows = channels == channel
            entries = np.empty(int(rows.sum()), dtype=INDEX_ENTRY)
            entries["time"], entries["offset"] = batch.times[rows], starts[rows] + offset
            self._entries[channel].append(entries)

    def _append_each(self, channels: Indices, batch: Batch) -> None:
        """Append messages to the chunk one by one."""
        for row, head in enumerate(_heads(channels, batch)):
            self.chunk.bio.write(head.tobytes())
            self.chunk.bio.write(batch.raw(row))

    def close_chunk(self) -> None:
        """Have the pending chunk compressed, and write the one that was closed some chunks before."""
        compressor: Callable[[Any], bytes] = self.compressor
        packed = self._packer.submit(compressor, self.chunk.bio.getbuffer())
        self._closed.append(_Closed(self.chunk, self._entries, packed))
        self.chunk = mcap.PendingChunk(2**63 - 1, 0, BytesIO(), defaultdict(list))
        self._entries = defaultdict(list)
        self._write_closed(MOST_CLOSED)

    def _write_closed(self, left: int) -> None:
        """Write closed chunks in their order until so many are left."""
        while len(self._closed) > left:
            closed = self._closed.popleft()
            self._write_chunk(closed.chunk, closed.entries, closed.packed.result())

    def _write_chunk(self, chunk: mcap.PendingChunk, entries: dict[int, list[NDArray[np.void]]], packed: bytes) -> None:
        """Write a chunk and its message indexes."""
        size, compression = chunk.bio.tell(), self.compression
        span = chunk.message_start_time, chunk.message_end_time
        start = self.bio.tell()
        record = _numbers(*span, size)
        mcap.write_uint32(record, 0)  # no checksum, as the library
        mcap.write_string(record, compression)
        mcap.write_uint64(record, len(packed))
        self.bio.write(_CHUNK.to_bytes(1, "little"))
        mcap.write_uint64(self.bio, record.tell() + len(packed))
        self.bio.write(record.getbuffer())
        self.bio.write(packed)
        end = self.bio.tell()
        offsets = {channel: self._write_index(channel, some) for channel, some in entries.items()}
        record = _numbers(*span, start, end - start)
        mcap.write_uint32(record, len(offsets) * 10)
        for channel, offset in offsets.items():
            mcap.write_uint16(record, channel)
            mcap.write_uint64(record, offset)
        mcap.write_uint64(record, self.bio.tell() - end)
        mcap.write_string(record, compression)
        mcap.write_uint64(record, len(packed))
        mcap.write_uint64(record, size)
        self.chunks.append(record)

    def close(self, version: int, metadata: str) -> None:
        """Write what is left, and the summary."""
        if self.chunk.bio.tell():
            self.close_chunk()
        self._write_closed(0)
        self._packer.shutdown()
        super().close(version, metadata)

    def abort(self) -> None:
        """Close without writing what is left."""
        self._packer.shutdown(cancel_futures=True)
        super().abort()

    def _write_index(self, channel: int, entries: list[NDArray[np.void]]) -> int:
        """Write the message index of a channel and return its place."""
        start, content = int(self.bio.tell()), np.concatenate(entries).tobytes()
        record = BytesIO()
        mcap.write_uint16(record, channel)
        mcap.write_uint32(record, len(content))
        record.write(content)
        mcap.write_record(self.bio, MESSAGE_INDEX, record)
        return start


def _numbers(*numbers: int) -> BytesIO:
    record = BytesIO()
    for number in numbers:
        mcap.write_uint64(record, number)
    return record


def _heads(channels: Indices, batch: Batch) -> NDArray[np.void]:
    """Return what stands before the data of messages, (n,) of MESSAGE_HEAD."""
    heads = np.empty(len(batch), dtype=MESSAGE_HEAD)
    heads["kind"], heads["length"] = MESSAGE, batch.sizes + MESSAGE_HEAD.itemsize - RECORD_HEAD
    heads["channel"], heads["sequence"] = channels, 0
    heads["logged"] = heads["sent"] = batch.times
    return heads


def _records(channels: Indices, batch: Batch, starts: Indices, size: int) -> NDArray[np.uint8]:
    """Return the Message records (size,) of a batch, each at its place in ``starts`` (n,)."""
    made = np.empty(size, dtype=np.uint8)
    heads = _heads(channels, batch)
    windows(made, MESSAGE_HEAD.itemsize, writeable=True)[starts] = heads.view(np.uint8).reshape(len(batch), -1)
    data = starts + MESSAGE_HEAD.itemsize
    for length in np.unique(batch.sizes).tolist():
        rows = np.flatnonzero(batch.sizes == length)
        if length:
            windows(made, length, writeable=True)[data[rows]] = windows(batch.memory, length)[batch.starts[rows]]
    return made
