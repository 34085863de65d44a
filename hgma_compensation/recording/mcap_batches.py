"""The messages of an MCAP file in the order of their log times, chunk by chunk."""

from collections.abc import Generator, Iterator, Mapping
from typing import Any, BinaryIO

import numpy as np
from rosbags.rosbag2 import storage_mcap as mcap

from hgma_compensation.recording.batch import Batch, Indices, joined
from hgma_compensation.recording.mcap_records import RECORD_HEAD, find_messages

Placed = tuple[int, Batch]
"""Messages of a chunk with its place in the file."""

MOST_MESSAGES = 1 << 16
"""Of chunks that overlap in time, handed out at once."""

_CHECKSUM_AT = 24
"""Bytes of a chunk's two times and its unpacked size, before the checksum."""

_FIXED = 40
"""Bytes of all that a chunk's data is preceded by, but for the name of its compression."""


def is_plain(reader: Any) -> bool:
    """Return whether a McapReader's file has what ``mcap_batches`` goes by: an index of chunks that differ."""
    places = [chunk.chunk_start_offset for chunk in reader.chunks]
    return bool(places) and len(set(places)) == len(places) and all(c.message_end_time < 2**63 for c in reader.chunks)


def mcap_batches(reader: Any, topics: Mapping[int, int]) -> Iterator[Batch]:
    """Yield the messages of the channels in ``topics``, which gives the topic in the batch of each channel's id.

    reader: an open McapReader whose file is plain. The order is that of its ``messages``: by log time, then by place.
    """
    wanted = [chunk for chunk in reader.chunks if any(chunk.channel_count.get(channel, 0) for channel in topics)]
    numbers = np.full(1 << 16, -1, dtype=np.int64)
    for channel, number in topics.items():
        numbers[channel] = number
    # Unpacked, but perhaps later than what is not unpacked yet.
    waiting: list[Placed] = []
    for chunk in sorted(wanted, key=lambda chunk: chunk.message_start_time):
        waiting = yield from _handed_out(waiting, chunk.message_start_time)
        waiting.append((chunk.chunk_start_offset, _sorted(_unpacked(reader.bio, chunk, numbers))))
    yield from _handed_out(waiting, None)


def _unpacked(bio: BinaryIO, chunk: Any, numbers: Indices) -> Batch:
    """Return the wanted messages of a chunk as they lie there."""
    bio.seek(chunk.chunk_start_offset + RECORD_HEAD + _CHECKSUM_AT)
    checksum = int.from_bytes(mcap.read_exact(bio, 4), "little")
    bio.seek(chunk.chunk_start_offset + RECORD_HEAD + _FIXED + len(chunk.compression))
    packed = mcap.read_exact(bio, chunk.compressed_size)
    data = mcap.decompress(packed, chunk.compression, chunk.uncompressed_size, checksum)
    messages = find_messages(data, _index(bio, chunk))
    topics = numbers[messages.channels]
    rows = np.flatnonzero(
        (topics >= 0) & (messages.times >= chunk.message_start_time) & (messages.times <= chunk.message_end_time)
    )
    times = messages.times[rows].astype(np.int64)
    memory = np.frombuffer(data, dtype=np.uint8)
    return Batch(topics[rows], times, memory, messages.starts[rows], messages.sizes[rows])


def _index(bio: BinaryIO, chunk: Any) -> bytes:
    """Return the bytes of the message indexes after a chunk; one that is larger than the chunk is none."""
    size = chunk.message_index_length
    if size > chunk.uncompressed_size + (1 << 16):
        return b""
    bio.seek(chunk.chunk_start_offset + chunk.chunk_length)
    return bio.read(size)


def _sorted(batch: Batch) -> Batch:
    """Return a batch in the order of log times, those of equal ones as they were."""
    if (batch.times[1:] >= batch.times[:-1]).all():
        return batch
    return batch.select(np.argsort(batch.times, kind="stable"))


def _handed_out(waiting: list[Placed], before: int | None) -> Generator[Batch, None, list[Placed]]:
    """Yield the messages before a log time (ns), all for None; return what goes on waiting."""
    parts, left = [], []
    for place, batch in waiting:
        count = len(batch) if before is None else int(batch.times.searchsorted(before))
        if count:
            parts.append((place, batch.select(slice(count))))
        if count < len(batch):
            left.append((place, batch.select(slice(count, None))))
    if len(parts) == 1:
        yield parts[0][1]
    elif parts:
        yield from _merged([batch for _, batch in sorted(parts, key=lambda part: part[0])])
    return left


def _merged(parts: list[Batch]) -> Iterator[Batch]:
    """Yield messages of chunks that overlap, these being in the order of their places."""
    part = np.repeat(np.arange(len(parts)), [len(batch) for batch in parts])
    row = np.concatenate([np.arange(len(batch)) for batch in parts])
    order = np.argsort(np.concatenate([batch.times for batch in parts]), kind="stable")
    for start in range(0, len(order), MOST_MESSAGES):
        rows = order[start : start + MOST_MESSAGES]
        present = np.unique(part[rows])
        pieces = [parts[number].select(row[rows[part[rows] == number]]).compact() for number in present.tolist()]
        # Where each message of the window is once its pieces lie one after the other.
        yield joined(pieces).select(np.argsort(np.argsort(part[rows], kind="stable"), kind="stable"))
