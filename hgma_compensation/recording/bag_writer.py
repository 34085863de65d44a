"""Writes rosbag2 folders; each appears whole or not at all."""

import sqlite3
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from enum import Enum
from pathlib import Path
from typing import Any

from rosbags.interfaces import Connection
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin

from hgma_compensation.errors import RefusedError
from hgma_compensation.files import new_directory
from hgma_compensation.progress import Advance, counted
from hgma_compensation.recording import typestore as types
from hgma_compensation.recording.bag_events import merged
from hgma_compensation.recording.batch import Batch
from hgma_compensation.recording.bulk_writer import BulkWriter
from hgma_compensation.recording.ground_truth import GroundTruth
from hgma_compensation.recording.recording import Recording
from hgma_compensation.stamps import NANOSECONDS


class Storage(str, Enum):
    """Storage plug-in of a rosbag2 folder; MCAP is what ROS 2 Jazzy writes by default."""

    MCAP = "mcap"
    SQLITE3 = "sqlite3"


class BagWriter:
    """An open bag; messages are serialised with the types of ROS 2 Jazzy and hgma_msgs."""

    def __init__(self, writer: BulkWriter) -> None:
        """Wrap a writer that is open."""
        self._writer = writer
        self.typestore = types.typestore()

    def topic(self, name: str, message_type: str) -> Connection:
        """Add a topic."""
        return self._writer.add_connection(name, message_type, typestore=types.typestore_of(message_type))

    def copy_topic(self, connection: Connection) -> Connection:
        """Add a topic of another bag, type definition and QoS included; raises RefusedError where that cannot be."""
        try:
            return self._writer.add_connection(
                connection.topic,
                connection.msgtype,
                msgdef=connection.msgdef.data or None,
                rihs01=connection.digest or None,
                typestore=types.typestore_of(connection.msgtype),
                offered_qos_profiles=getattr(connection.ext, "offered_qos_profiles", ()),
            )
        except Exception as error:  # whatever the library makes of a definition or a QoS from outside
            raise RefusedError(
                f"topic {connection.topic} of type {connection.msgtype} cannot be copied ({error}): "
                "give the bag's folder, or record it again without that topic"
            ) from error

    def write(self, connection: Connection, time: int, message: Any) -> None:
        """Write a message at a log time in ns."""
        self.write_raw(connection, time, self.typestore.serialize_cdr(message, connection.msgtype))

    def write_raw(self, connection: Connection, time: int, raw: bytes | memoryview) -> None:
        """Write a serialised message at a log time in ns."""
        self._writer.write(connection, time, raw)

    def write_batch(self, connections: Sequence[Connection], batch: Batch) -> None:
        """Write many messages; the topic of each in the batch is the place of its connection in ``connections``."""
        self._writer.write_batch(connections, batch)

    def note(self, key: str, text: str) -> None:
        """Put a text into the custom data of the bag's metadata.yaml."""
        self._writer.set_custom_data(key, text)

    def header(self, stamp: int, frame: str) -> Any:
        """Return a std_msgs/Header."""
        time = self.typestore.types["builtin_interfaces/msg/Time"](stamp // NANOSECONDS, stamp % NANOSECONDS)
        return self.typestore.types["std_msgs/msg/Header"](time, frame)


@contextmanager
def new_bag(path: Path, storage: Storage = Storage.MCAP) -> Iterator[BagWriter]:
    """Give a writer of a new bag; raises RefusedError where the path exists or cannot be written."""
    with new_directory(path) as scratch:
        writer = BulkWriter(scratch, version=9, storage_plugin=StoragePlugin[storage.name])
        if storage is Storage.MCAP:
            writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
        try:
            with writer:
                yield BagWriter(writer)
        except sqlite3.OperationalError as error:  # a full disk, which the other storage tells as the system does
            raise RefusedError(f"{path} cannot be written ({error}): choose another place") from None


def write_recording(
    recording: Recording,
    path: Path,
    storage: Storage = Storage.MCAP,
    progress: Advance | None = None,
    truth: GroundTruth | None = None,
    block: int = 1,
) -> None:
    """Write a recording under the node's topic names, a simulation's truth beside it; log times are the stamps.

    At equal stamps the thermistor comes first, as a driver that reads it with the accelerometer sends it.
    block: accelerometer samples in one message; above 1 they are AccelBlocks, logged at their last sample.
    """
    with new_bag(path, storage) as bag:
        for time, _, connection, message in counted(merged(bag, recording, truth, block), progress):
            bag.write(connection, time, message)
