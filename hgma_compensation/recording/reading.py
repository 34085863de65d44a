"""One pass over the topics of a bag: slow inputs into series, samples of the accelerometer to where they are kept."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rosbags.interfaces import Connection

from hgma_compensation.channels import CHANNELS, GROUPS
from hgma_compensation.errors import RefusedError
from hgma_compensation.recording.accelerations import BlockMessages, ImuMessages
from hgma_compensation.recording.bag import Bag
from hgma_compensation.recording.bag_topics import BagTopics
from hgma_compensation.recording.batch import Batch, Indices
from hgma_compensation.recording.growing import Growing
from hgma_compensation.recording.recording import Series, present_channels
from hgma_compensation.recording.slow_inputs import read_slow
from hgma_compensation.stamps import Stamps


class Samples:
    """Samples of the accelerometer as they are read; where they are kept is for others to say."""

    def __init__(self) -> None:
        """Begin without samples."""
        self.not_zero = np.zeros(len(CHANNELS), dtype=np.bool_)

    def declare(self, count: int) -> None:
        """Take notice of the number of messages that a bag says it has."""

    def __len__(self) -> int:
        """Return the number of samples."""
        raise NotImplementedError

    def add(self, stamps: Stamps, values: NDArray[np.float64], counts: Indices | None) -> None:
        """Take samples (n,) ns and (n, 6); counts: (blocks,) in each AccelBlock, None of single messages."""
        self.not_zero |= (values != 0.0).any(axis=0)


class Held(Samples):
    """Samples in memory."""

    def __init__(self) -> None:
        """Begin without samples."""
        super().__init__()
        self._counts: list[Indices] = []
        self.declare(0)

    def declare(self, count: int) -> None:
        """Make room for as many samples."""
        self.stamps, self.values = Growing(count, np.int64), Growing(count, np.float64, (len(CHANNELS),))

    def __len__(self) -> int:
        """Return the number of samples."""
        return len(self.stamps)

    def add(self, stamps: Stamps, values: NDArray[np.float64], counts: Indices | None) -> None:
        """Take samples."""
        super().add(stamps, values, counts)
        self.stamps.extend(stamps)
        self.values.extend(values)
        if counts is not None:
            self._counts.append(counts)

    @property
    def block(self) -> Indices | None:
        """Number of the AccelBlock (n,) of each sample, None of single messages."""
        if not self._counts:
            return None
        counts = np.concatenate(self._counts)
        return np.repeat(np.arange(len(counts)), counts)


@dataclass(frozen=True)
class Read:
    """What a bag holds beside the samples of the accelerometer; series: by the names of Recording's fields."""

    name: str
    present: tuple[str, ...]
    frame: str
    series: dict[str, Series]


class Reading:
    """One pass over the topics of an open bag."""

    def __init__(self, reader: Bag, path: Path, found: BagTopics, samples: Samples) -> None:
        """Read into samples."""
        self._path, self._found = path, found
        self._decoders = [decoder(reader, path, connection) for connection in found.read]
        self._fast = [number for number, c in enumerate(found.read) if c in found.accelerometer]
        self._samples = samples
        samples.declare(sum(connection.msgcount for connection in found.accelerometer))
        self._carried: set[str] = set()
        self._frame = ""
        self._series = []
        for slow, connections in found.slow:
            numbers = [number for number, c in enumerate(found.read) if c in connections]
            count = sum(connection.msgcount for connection in connections)
            self._series.append((slow, numbers, Growing(count, np.int64), Growing(count, np.float64)))

    def take(self, batch: Batch) -> None:
        """Take messages of the topics ``found.read``."""
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
        else:
            messages = ImuMessages(batch, decode)
        self._samples.add(messages.stamps, messages.values, messages.counts if self._found.blocks else None)
        self._carried |= messages.carried
        ((_, self._frame),) = messages.frames(np.array([len(batch) - 1]))

    def read(self) -> Read:
        """Return the rest once all messages were taken; raises RefusedError where there was no sample."""
        if not len(self._samples):
            raise no_samples(self._path, self._found)
        series = {slow.series: Series(s.array(), v.array()) for slow, _, s, v in self._series}
        present = present_channels(self._samples.not_zero, set(GROUPS) - self._carried)
        return Read(self._path.name, present, self._frame, series)


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


def no_samples(path: Path, found: BagTopics) -> RefusedError:
    """Return the refusal of a bag whose accelerometer has no message though some are declared."""
    return RefusedError(
        f"bag {path} holds no sample on {found.accelerometer[0].topic}, though it declares messages: "
        "it is damaged, record or copy it again"
    )
