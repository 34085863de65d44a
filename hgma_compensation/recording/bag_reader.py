"""Reads a recording out of a rosbag2 folder or file, MCAP or SQLite."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from rosbags.interfaces import Connection

from hgma_compensation import topics
from hgma_compensation.channels import CHANNELS, GROUPS
from hgma_compensation.errors import RefusedError
from hgma_compensation.progress import Advance
from hgma_compensation.recording.accelerations import BlockMessages, ImuMessages
from hgma_compensation.recording.bag import Bag
from hgma_compensation.recording.bag_topics import BagTopics
from hgma_compensation.recording.batch import Batch, Indices
from hgma_compensation.recording.growing import Growing
from hgma_compensation.recording.recording import Recording, Series, present_channels
from hgma_compensation.recording.slow_inputs import read_slow


@contextmanager
def open_bag(path: Path) -> Iterator[Bag]:
    """Open a bag; raises RefusedError where it is none, is damaged, or ends too early."""
    path = Path(path)
    if not path.exists():
        raise RefusedError(f"bag {path} does not exist: give a rosbag2 folder or an .mcap or .db3 file")
    if path.is_dir() and not (path / "metadata.yaml").exists():
        raise RefusedError(
            f"bag {path} has no metadata.yaml: if recording was cut off, run ros2 bag reindex {path.name}"
        )
    reader = None
    try:
        reader = Bag(path)
    except RefusedError as refusal:
        raise RefusedError(f"bag {path}: {refusal}") from None
    except Exception as error:  # whatever a parser raises on damaged bytes
        raise RefusedError(f"bag {path} cannot be read ({error}): it is damaged or no rosbag2 recording") from error
    try:
        yield reader
    finally:
        reader.close()


def read_messages(reader: Bag, path: Path, connections: list[Connection]) -> Iterator[tuple[Connection, int, bytes]]:
    """Yield the messages; a damaged storage raises RefusedError instead of the library's error."""
    try:
        yield from reader.messages(connections)
    except Exception as error:  # whatever a parser raises on damaged bytes
        raise RefusedError(f"bag {path} is damaged ({error}): record or copy it again") from error


def bulk_messages(reader: Bag, path: Path, connections: list[Connection]) -> Iterator[Batch]:
    """Yield the messages many at a time, as ``Bag.batches`` does; a damaged storage raises RefusedError."""
    try:
        yield from reader.batches(connections)
    except Exception as error:  # whatever a parser raises on damaged bytes
        raise RefusedError(f"bag {path} is damaged ({error}): record or copy it again") from error


def decoder(reader: Bag, path: Path, connection: Connection) -> Callable[[bytes], Any]:
    """Return what makes message objects of a topic's messages; a damaged one raises RefusedError."""

    def decode(raw: bytes) -> Any:
        try:
            return reader.deserialize(raw, connection.msgtype)
        except Exception as error:  # whatever a parser raises on damaged bytes
            raise RefusedError(
                f"bag {path}: a message on {connection.topic} is damaged ({error}): record it again"
            ) from error

    return decode


def read_recording(path: Path, names: topics.TopicNames | None = None, progress: Advance | None = None) -> Recording:
    """Return a bag as a recording.

    Accelerations come from the message topic, or from the block topic where there are no messages.
    Raises RefusedError where there is neither, or where a topic has another type.
    """
    with open_bag(path) as reader:
        found = BagTopics(reader, Path(path), names or topics.TopicNames())
        reading = _Reading(reader, Path(path), found)
        for batch in bulk_messages(reader, Path(path), found.read):
            reading.take(batch)
            if progress is not None:
                progress(len(batch))
        return reading.recording()


class _Reading:
    """One pass over the topics of an open bag."""

    def __init__(self, reader: Bag, path: Path, found: BagTopics) -> None:
        self._path, self._found = path, found
        self._decoders = [decoder(reader, path, connection) for connection in found.read]
        self._fast = [number for number, c in enumerate(found.read) if c in found.accelerometer]
        count = sum(connection.msgcount for connection in found.accelerometer)
        self._stamps, self._values = Growing(count, np.int64), Growing(count, np.float64, (len(CHANNELS),))
        self._counts: list[Indices] = []
        self._carried: set[str] = set()
        self._frame = ""
        self._series = []
        for slow, connections in found.slow:
            numbers = [number for number, c in enumerate(found.read) if c in connections]
            count = sum(connection.msgcount for connection in connections)
            self._series.append((slow, numbers, Growing(count, np.int64), Growing(count, np.float64)))

    def take(self, batch: Batch) -> None:
        rows = np.flatnonzero(np.isin(batch.topics, self._fast))
        if len(rows):
            self._take_accelerations(batch.select(rows), self._decoders[int(batch.topics[rows[0]])])
        for slow, numbers, stamps, values in self._series:
            rows = np.flatnonzero(np.isin(batch.topics, numbers))
            if len(rows):
                series = read_slow(batch.select(rows), slow, self._decoders[numbers[0]])
                stamps.extend(series.stamps)
                values.extend(series.values)

    def _take_accelerations(self, batch: Batch, decode: Callable[[bytes], Any]) -> None:
        messages: ImuMessages | BlockMessages
        if self._found.blocks:
            messages = BlockMessages(batch, decode, f"bag {self._path}")
            self._counts.append(messages.counts)
        else:
            messages = ImuMessages(batch, decode)
        self._stamps.extend(messages.stamps)
        self._values.extend(messages.values)
        self._carried |= messages.carried
        ((_, self._frame),) = messages.frames(np.array([len(batch) - 1]))

    def recording(self) -> Recording:
        stamps, values = self._stamps.array(), self._values.array()
        if not len(stamps):
            raise no_samples(self._path, self._found)
        series = {slow.series: Series(s.array(), v.array()) for slow, _, s, v in self._series}
        present = present_channels(values, set(GROUPS) - self._carried)
        block = None
        if self._found.blocks:
            counts = np.concatenate(self._counts)
            block = np.repeat(np.arange(len(counts)), counts)
        return Recording(self._path.name, stamps, values, present, frame=self._frame, block=block, **series)


def no_samples(path: Path, found: BagTopics) -> RefusedError:
    """Return the refusal of a bag whose accelerometer has no message though some are declared."""
    return RefusedError(
        f"bag {path} holds no sample on {found.accelerometer[0].topic}, though it declares messages: "
        "it is damaged, record or copy it again"
    )
