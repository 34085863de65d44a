"""Writes rosbag2 folders; each appears whole or not at all."""

import heapq
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from enum import Enum
from pathlib import Path
from typing import Any

import numpy as np
from rosbags.interfaces import Connection
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer

from hgma_compensation import topics
from hgma_compensation.channels import GROUPS, group_of
from hgma_compensation.files import new_directory
from hgma_compensation.recording import typestore as types
from hgma_compensation.recording.recording import Recording, Series
from hgma_compensation.stamps import NANOSECONDS

Progress = Callable[[int], None]
Event = tuple[int, int, Connection, Any]


class Storage(str, Enum):
    """Storage plug-in of a rosbag2 folder; MCAP is what ROS 2 Jazzy writes by default."""

    MCAP = "mcap"
    SQLITE3 = "sqlite3"


class BagWriter:
    """An open bag; messages are serialised with the types of ROS 2 Jazzy and hgma_msgs."""

    def __init__(self, writer: Writer) -> None:
        """Wrap a writer that is open."""
        self._writer = writer
        self.typestore = types.typestore()

    def topic(self, name: str, message_type: str) -> Connection:
        """Add a topic."""
        return self._writer.add_connection(name, message_type, typestore=self.typestore)

    def copy_topic(self, connection: Connection) -> Connection:
        """Add a topic of another bag, type definition and QoS included."""
        return self._writer.add_connection(
            connection.topic,
            connection.msgtype,
            msgdef=connection.msgdef.data or None,
            rihs01=connection.digest or None,
            typestore=self.typestore,
            offered_qos_profiles=getattr(connection.ext, "offered_qos_profiles", ()),
        )

    def write(self, connection: Connection, time: int, message: Any) -> None:
        """Write a message at a log time in ns."""
        self.write_raw(connection, time, self.typestore.serialize_cdr(message, connection.msgtype))

    def write_raw(self, connection: Connection, time: int, raw: bytes | memoryview) -> None:
        """Write a serialised message at a log time in ns."""
        self._writer.write(connection, time, raw)

    def header(self, stamp: int, frame: str) -> Any:
        """Return a std_msgs/Header."""
        time = self.typestore.types["builtin_interfaces/msg/Time"](stamp // NANOSECONDS, stamp % NANOSECONDS)
        return self.typestore.types["std_msgs/msg/Header"](time, frame)


@contextmanager
def new_bag(path: Path, storage: Storage = Storage.MCAP) -> Iterator[BagWriter]:
    """Give a writer of a new bag; raises RefusedError where the path exists or cannot be written."""
    with new_directory(path) as scratch:
        writer = Writer(scratch, version=9, storage_plugin=StoragePlugin[storage.name])
        if storage is Storage.MCAP:
            writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
        with writer:
            yield BagWriter(writer)


def write_recording(
    recording: Recording, path: Path, storage: Storage = Storage.MCAP, progress: Progress | None = None
) -> None:
    """Write a recording under the node's topic names; log times are the stamps.

    At equal stamps the thermistor comes first, as a driver that reads it with the accelerometer sends it.
    """
    with new_bag(path, storage) as bag:
        events = _merge(bag, recording)
        for count, (time, _, connection, message) in enumerate(events):
            bag.write(connection, time, message)
            if progress is not None and count % 1000 == 999:
                progress(1000)


def _merge(bag: BagWriter, recording: Recording) -> Iterator[Event]:
    scalars = (
        (topics.TEMPERATURE, types.TEMPERATURE, recording.temperature),
        (topics.TEMPERATURE_2, types.TEMPERATURE, recording.temperature_2),
        (topics.SUPPLY_VOLTAGE, types.SUPPLY_VOLTAGE, recording.supply_voltage),
    )
    streams = [
        _scalar_events(bag, bag.topic(topics.in_bag(topic), message_type), rank, series, recording.frame)
        for rank, (topic, message_type, series) in enumerate(scalars)
        if len(series.stamps)
    ]
    streams.append(_imu_events(bag, bag.topic(topics.in_bag(topics.RAW), types.IMU), len(scalars), recording))
    return heapq.merge(*streams, key=lambda event: event[:2])


def _scalar_events(bag: BagWriter, connection: Connection, rank: int, series: Series, frame: str) -> Iterator[Event]:
    message_type = bag.typestore.types[connection.msgtype]
    # A Temperature carries its variance, 0 for unknown; a SupplyVoltage has no such field.
    rest = (0.0,) if connection.msgtype == types.TEMPERATURE else ()
    for stamp, value in zip(series.stamps.tolist(), series.values.tolist(), strict=True):
        yield stamp, rank, connection, message_type(bag.header(stamp, frame), value, *rest)


def _imu_events(bag: BagWriter, connection: Connection, rank: int, recording: Recording) -> Iterator[Event]:
    imu, vector = bag.typestore.types[types.IMU], bag.typestore.types["geometry_msgs/msg/Vector3"]
    no_rotation = bag.typestore.types["geometry_msgs/msg/Quaternion"](0.0, 0.0, 0.0, 1.0)
    unknown, absent = np.zeros(9), np.r_[-1.0, np.zeros(8)]
    here = {group_of(channel) for channel in recording.present}
    acceleration, rate = (unknown if group in here else absent for group in GROUPS)
    for stamp, row in zip(recording.stamps.tolist(), recording.values.tolist(), strict=True):
        message = imu(
            bag.header(stamp, recording.frame),
            no_rotation,
            absent,
            vector(*row[3:]),
            rate,
            vector(*row[:3]),
            acceleration,
        )
        yield stamp, rank, connection, message
