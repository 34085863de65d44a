"""The messages that a recording consists of, in the order in which a bag holds them."""

from __future__ import annotations

import heapq
import json
from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from rosbags.interfaces import Connection

from hgma_compensation import topics
from hgma_compensation.channels import AXES, CHANNELS, GROUPS, group_of
from hgma_compensation.recording import typestore as types
from hgma_compensation.recording.ground_truth import (
    ACCELERATION_TOPIC,
    DECLARED_EFFECTS,
    DRIFT_TOPIC,
    TEMPERATURE_TOPIC,
    GroundTruth,
)
from hgma_compensation.recording.recording import Recording, Series
from hgma_compensation.stamps import NANOSECONDS

if TYPE_CHECKING:
    from hgma_compensation.recording.bag_writer import BagWriter

Event = tuple[int, int, Connection, Any]
"""Log time in ns, rank among equal times, topic, message."""


def merged(bag: BagWriter, recording: Recording, truth: GroundTruth | None, block: int) -> Iterator[Event]:
    """Yield all messages in the order of their log times; at equal ones the accelerometer after the thermometers."""
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
    if block > 1:
        topic = bag.topic(topics.in_bag(topics.RAW_BLOCK), types.ACCEL_BLOCK)
        streams.append(_block_events(bag, topic, len(scalars), recording, block))
    else:
        streams.append(_imu_events(bag, bag.topic(topics.in_bag(topics.RAW), types.IMU), len(scalars), recording))
    if truth is not None:
        streams += _truth_events(bag, len(scalars) + 1, recording, truth)
    return heapq.merge(*streams, key=lambda event: event[:2])


def _truth_events(bag: BagWriter, rank: int, recording: Recording, truth: GroundTruth) -> list[Iterator[Event]]:
    bag.note(DECLARED_EFFECTS, json.dumps(truth.declared))
    temperature = bag.topic(TEMPERATURE_TOPIC, types.TEMPERATURE)
    series = Series(recording.stamps, truth.temperature)
    streams = [_scalar_events(bag, temperature, rank, series, recording.frame)]
    for number, (topic, vectors) in enumerate(
        ((ACCELERATION_TOPIC, truth.acceleration), (DRIFT_TOPIC, truth.drift)), start=rank + 1
    ):
        wide = replace(recording, values=np.hstack([vectors, np.zeros_like(vectors)]), present=CHANNELS[:3])
        streams.append(_imu_events(bag, bag.topic(topic, types.IMU), number, wide))
    return streams


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


def _block_events(
    bag: BagWriter, connection: Connection, rank: int, recording: Recording, size: int
) -> Iterator[Event]:
    """Yield blocks of up to ``size`` samples; one ends where the interval changes, as after a break."""
    message_type = bag.typestore.types[connection.msgtype]
    interval = float(np.median(np.diff(recording.stamps))) if len(recording.stamps) > 1 else NANOSECONDS
    breaks = np.flatnonzero(np.abs(np.diff(recording.stamps) - interval) > 0.5 * interval) + 1
    for part in np.split(np.arange(len(recording.stamps)), breaks):
        for rows in np.split(part, np.arange(size, len(part), size)):
            first, last = int(recording.stamps[rows[0]]), int(recording.stamps[rows[-1]])
            spacing = (last - first) / (len(rows) - 1) if len(rows) > 1 else interval
            axes = np.ascontiguousarray(recording.values[rows, : len(AXES)].T, dtype=np.float32)
            message = message_type(bag.header(first, recording.frame), spacing / NANOSECONDS, *axes)
            yield last, rank, connection, message
