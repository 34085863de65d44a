"""Reads a recording out of a rosbag2 folder or file, MCAP or SQLite."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from rosbags.interfaces import Connection

from hgma_compensation import topics
from hgma_compensation.channels import CHANNELS
from hgma_compensation.errors import RefusedError
from hgma_compensation.messages import absent_groups, block_samples, imu_values, stamp_of, widen_block
from hgma_compensation.progress import Advance, counted
from hgma_compensation.recording import typestore as types
from hgma_compensation.recording.bag import Bag
from hgma_compensation.recording.growing import Growing
from hgma_compensation.recording.recording import Recording, Series, present_channels
from hgma_compensation.stamps import Stamps


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


def connections_of(reader: Bag, topic: str, message_type: str, path: Path) -> list[Connection]:
    """Return the connections of a topic; raises RefusedError where it has another type."""
    found = [connection for connection in reader.connections if connection.topic == topic]
    for connection in found:
        if connection.msgtype != message_type:
            raise RefusedError(
                f"bag {path}: {topic} is a {connection.msgtype}, must be {message_type}: "
                "name the right topic with --remap"
            )
    return found


def read_recording(path: Path, names: topics.TopicNames | None = None, progress: Advance | None = None) -> Recording:
    """Return a bag as a recording.

    Accelerations come from the message topic, or from the block topic where there are no messages.
    Raises RefusedError where there is neither, or where a topic has another type.
    """
    names = names or topics.TopicNames()
    with open_bag(path) as reader:
        reading = _Reading(reader, Path(path), progress)
        imu = reading.connections(names[topics.RAW], types.IMU)
        blocks = [] if imu else reading.connections(names[topics.RAW_BLOCK], types.ACCEL_BLOCK)
        if not imu and not blocks:
            held = ", ".join(sorted({connection.topic for connection in reader.connections})) or "nothing"
            raise RefusedError(
                f"bag {path} holds no {names[topics.RAW]}, only {held}: "
                f"name the accelerometer's topic with --remap /{topics.RAW}:=/your/topic"
            )
        stamps, values, present, frame, block = reading.imu(imu) if imu else reading.blocks(blocks)
        scalars = {
            "temperature": reading.scalars(names[topics.TEMPERATURE], types.TEMPERATURE, "temperature"),
            "temperature_2": reading.scalars(names[topics.TEMPERATURE_2], types.TEMPERATURE, "temperature"),
            "supply_voltage": reading.scalars(names[topics.SUPPLY_VOLTAGE], types.SUPPLY_VOLTAGE, "voltage"),
        }
    return Recording(Path(path).name, stamps, values, present, frame=frame, block=block, **scalars)


class _Reading:
    """One pass over each topic of an open bag."""

    def __init__(self, reader: Bag, path: Path, progress: Advance | None) -> None:
        self._reader, self._path, self._progress = reader, path, progress

    def connections(self, topic: str, message_type: str) -> list[Connection]:
        found = connections_of(self._reader, topic, message_type, self._path)
        return found if any(connection.msgcount for connection in found) else []

    def _messages(self, connections: list[Connection]) -> Iterator[Any]:
        for connection, _, raw in counted(read_messages(self._reader, self._path, connections), self._progress):
            try:
                yield self._reader.deserialize(raw, connection.msgtype)
            except Exception as error:  # whatever a parser raises on damaged bytes
                raise RefusedError(f"bag {self._path}: a message on {connection.topic} is damaged ({error})") from error

    def imu(self, connections: list[Connection]) -> tuple[Any, ...]:
        count, frame = sum(connection.msgcount for connection in connections), ""
        stamps, values = Growing(count, np.int64), Growing(count, np.float64, (len(CHANNELS),))
        absent: set[str] | None = None
        for message in self._messages(connections):
            stamps.append(stamp_of(message))
            values.append(imu_values(message))
            absent = absent_groups(message) if absent is None else absent & absent_groups(message)
            frame = message.header.frame_id
        self._require(stamps.array(), connections)
        return stamps.array(), values.array(), present_channels(values.array(), absent or set()), frame, None

    def _require(self, stamps: Stamps, connections: list[Connection]) -> None:
        if not len(stamps):
            raise RefusedError(
                f"bag {self._path} holds no sample on {connections[0].topic}, though it declares messages: "
                "it is damaged, record or copy it again"
            )

    def blocks(self, connections: list[Connection]) -> tuple[Any, ...]:
        parts, frame = [], ""
        for message in self._messages(connections):
            parts.append(block_samples(message, f"bag {self._path}"))
            frame = message.header.frame_id
        stamps = np.concatenate([part[0] for part in parts] or [np.empty(0, dtype=np.int64)])
        self._require(stamps, connections)
        values = widen_block(np.concatenate([part[1] for part in parts]))
        block = np.repeat(np.arange(len(parts)), [len(part[0]) for part in parts])
        return stamps, values, present_channels(values, {"angular_velocity"}), frame, block

    def scalars(self, topic: str, message_type: str, attribute: str) -> Series:
        connections = self.connections(topic, message_type)
        count = sum(connection.msgcount for connection in connections)
        stamps, values = Growing(count, np.int64), Growing(count, np.float64)
        for message in self._messages(connections) if connections else ():
            stamps.append(stamp_of(message))
            values.append(getattr(message, attribute))
        return Series(stamps.array(), values.array())
