"""Recordings for the offline rows, made once and kept in a folder that git ignores."""

import heapq
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rosbags.interfaces import Connection

from benchmarks.bench.samples import SEED, THERMISTOR_NOISE, Array, accelerations, temperature
from benchmarks.soak.serialised import STAMP, STAMP_AT, acceleration_at, imu_template
from hgma_compensation import topics
from hgma_compensation.recording import typestore as types
from hgma_compensation.recording.bag_writer import BagWriter, Storage, new_bag
from hgma_compensation.stamps import NANOSECONDS, Stamps

Message = tuple[int, bytes | memoryview]
"""Log time in ns, and the message serialised."""

EPOCH = 1_600_000_000 * NANOSECONDS
CHUNK = 1_000_000
"""Samples that are made at once."""

CONTENT = 1
"""Counts up where the same description comes to mean other bytes, so that old files are not taken for new ones."""


@dataclass(frozen=True)
class Content:
    """What a bag holds: s, Hz of the accelerometer, samples in a message (1: Imu), Hz of the thermistor."""

    seconds: float
    rate: float
    block: int = 1
    thermistor_rate: float = 1.0
    storage: Storage = Storage.MCAP

    @property
    def name(self) -> str:
        """Return the folder's name."""
        numbers = f"{self.seconds:g}s_{self.rate:g}hz_{self.block}_{self.thermistor_rate:g}hz"
        return f"bag{CONTENT}_{numbers}_{self.storage.value}"

    @property
    def samples(self) -> int:
        """Return the number of accelerometer samples: whole blocks."""
        return int(self.seconds * self.rate) // self.block * self.block


def bag(content: Content, folder: Path) -> Path:
    """Return the path of a bag with that content; made where it is not there yet."""
    path = folder / content.name
    if not path.exists():
        with new_bag(path, content.storage) as writer:
            for connection, time, raw in _messages(content, writer):
                writer.write_raw(connection, time, raw)
    return path


def _messages(content: Content, writer: BagWriter) -> Iterator[tuple[Connection, int, bytes | memoryview]]:
    """Yield topic, log time (ns) and serialised message."""
    random = np.random.default_rng(SEED)
    thermistor = writer.topic(topics.in_bag(topics.TEMPERATURE), types.TEMPERATURE)
    kind = (topics.RAW_BLOCK, types.ACCEL_BLOCK) if content.block > 1 else (topics.RAW, types.IMU)
    accelerometer = writer.topic(topics.in_bag(kind[0]), kind[1])
    chunk = max(CHUNK // content.block, 1) * content.block
    slow_done = 0
    for first in range(0, content.samples, chunk):
        time = np.arange(first, min(first + chunk, content.samples)) / content.rate
        slow = np.arange(slow_done, int(time[-1] * content.thermistor_rate) + 1) / content.thermistor_rate
        slow_done += len(slow)
        celsius = temperature(slow) + THERMISTOR_NOISE * random.standard_normal(len(slow))
        values = accelerations(time, content.rate, random)
        pack = _blocks if content.block > 1 else _imus
        streams = (
            ((thermistor, *message) for message in _temperatures(writer, _stamps(slow), celsius)),
            ((accelerometer, *message) for message in pack(content, writer, _stamps(time), values)),
        )
        yield from heapq.merge(*streams, key=lambda message: message[1])


def _stamps(time: Array) -> Stamps:
    return EPOCH + np.rint(time * NANOSECONDS).astype(np.int64)


def _imus(content: Content, writer: BagWriter, stamps: Stamps, values: Array) -> Iterator[Message]:
    message, place = imu_template(), acceleration_at()
    for stamp, row in zip(stamps.tolist(), values, strict=True):
        STAMP.pack_into(message, STAMP_AT, *divmod(stamp, NANOSECONDS))
        message[place : place + row.nbytes] = row.tobytes()
        yield stamp, bytes(message)


def _blocks(content: Content, writer: BagWriter, stamps: Stamps, values: Array) -> Iterator[Message]:
    message_type = writer.typestore.types[types.ACCEL_BLOCK]
    single = values.astype(np.float32)
    for first in range(0, len(stamps), content.block):
        rows = slice(first, first + content.block)
        header = writer.header(int(stamps[first]), "imu_link")
        message = message_type(header, 1.0 / content.rate, *(np.ascontiguousarray(axis) for axis in single[rows].T))
        yield int(stamps[rows][-1]), writer.typestore.serialize_cdr(message, types.ACCEL_BLOCK)


def _temperatures(writer: BagWriter, stamps: Stamps, celsius: Array) -> Iterator[Message]:
    message_type = writer.typestore.types[types.TEMPERATURE]
    for stamp, value in zip(stamps.tolist(), celsius.tolist(), strict=True):
        message = message_type(writer.header(stamp, "imu_link"), value, 0.0)
        yield stamp, writer.typestore.serialize_cdr(message, types.TEMPERATURE)
