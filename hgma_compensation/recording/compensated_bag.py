"""Writes a bag again with the compensated topics beside the recorded ones."""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rosbags.interfaces import Connection

from hgma_compensation import topics
from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.channels import columns_of
from hgma_compensation.effects.effect import Effect, Need
from hgma_compensation.effects.stage import channels_read
from hgma_compensation.errors import RefusedError
from hgma_compensation.messages import patch_block, patch_covariances, patch_imu
from hgma_compensation.pipeline.compensated import Compensated
from hgma_compensation.pipeline.pipeline import Pipeline
from hgma_compensation.pipeline.screening import usable_samples
from hgma_compensation.pipeline.state_fields import state_fields
from hgma_compensation.progress import Advance, counted
from hgma_compensation.recording import typestore as types
from hgma_compensation.recording.bag import Bag
from hgma_compensation.recording.bag_reader import open_bag, read_messages
from hgma_compensation.recording.bag_writer import BagWriter, Storage, new_bag
from hgma_compensation.recording.recording import Recording


def usable_rows(recording: Recording, calibration: Calibration) -> NDArray[np.bool_]:
    """Return for each sample whether it is compensated; as in the node, one that is not costs its whole block."""
    usable = usable_samples(recording.stamps, recording.values[:, columns_of(calibration.channels_read)])
    if recording.block is None or usable.all():
        return usable
    return ~np.isin(recording.block, recording.block[~usable])


def check_covered(recording: Recording, calibration: Calibration) -> None:
    """Raise RefusedError where the recording lacks an input or a channel that the calibration needs."""
    recording.require_temperature()
    missing = [name for name in calibration.names if name not in recording.present]
    if missing:
        raise RefusedError(f"{recording.name} has no channel {', '.join(missing)}, which the calibration covers")
    for applied in calibration.effects:
        _check_effect(recording, applied.effect)


def _check_effect(recording: Recording, effect: Effect) -> None:
    wanted = f"which the effect {effect.name} of the calibration needs"
    for need, topic in ((Need.TEMPERATURE_2, topics.TEMPERATURE_2), (Need.SUPPLY_VOLTAGE, topics.SUPPLY_VOLTAGE)):
        if need in effect.needs and not np.isfinite(getattr(recording, need.value).values).any():
            name = topics.in_bag(topic)
            raise RefusedError(
                f"{recording.name} has no sample on {name}, {wanted}: record that topic, "
                f"name it with --remap {name}:=/your/topic, or use a calibration without the effect"
            )
    for channel in channels_read(effect):
        if channel not in recording.present:
            raise RefusedError(
                f"{recording.name} has no channel {channel}, {wanted}: use a calibration without the effect"
            )


def compensate_recording(recording: Recording, calibration: Calibration) -> Compensated:
    """Return the pipeline's result for the usable rows of a recording."""
    rows = usable_rows(recording, calibration)
    values = recording.values[rows]
    pipeline = Pipeline(calibration)
    feed(pipeline, recording)
    return pipeline.compensate(recording.stamps[rows], values[:, columns_of(calibration.names)], values)


def feed(pipeline: Pipeline, recording: Recording) -> None:
    """Give a pipeline the thermometers and the supply voltage of a recording."""
    inputs = (
        (pipeline.add_temperature, recording.temperature),
        (pipeline.add_temperature_2, recording.temperature_2),
        (pipeline.add_supply_voltage, recording.supply_voltage),
    )
    for add, series in inputs:
        for stamp, value in zip(series.stamps.tolist(), series.values.tolist(), strict=True):
            add(stamp, value)


def write_compensated(
    source: Path,
    recording: Recording,
    calibration: Calibration,
    path: Path,
    *,
    names: topics.TopicNames,
    storage: Storage = Storage.MCAP,
    progress: Advance | None = None,
) -> Compensated:
    """Write the bag ``source`` with the output topics of the node added, and return the result.

    recording: as read from ``source``. Output topics that the source already has are replaced.
    """
    result = compensate_recording(recording, calibration)
    with open_bag(source) as reader, new_bag(path, storage) as bag:
        copying = _Copy(reader, bag, names, calibration, result, usable_rows(recording, calibration))
        for connection, time, raw in counted(read_messages(reader, source, copying.sources), progress):
            copying.take(connection, time, raw)
    return result


class _Copy:
    """Copies messages, and adds to each accelerometer message what the pipeline made of it."""

    def __init__(
        self,
        reader: Bag,
        bag: BagWriter,
        names: topics.TopicNames,
        calibration: Calibration,
        result: Compensated,
        usable: NDArray[np.bool_],
    ) -> None:
        outputs = {topics.in_bag(topic) for topic in topics.OUTPUTS}
        self.sources = [c for c in reader.connections if c.topic not in outputs]
        self._reader, self._bag, self._calibration = reader, bag, calibration
        self._result, self._usable = result, usable
        self._copies = {c.id: bag.copy_topic(c) for c in self.sources}
        imu = {c.id for c in self.sources if c.topic == names[topics.RAW]}
        blocks = {c.id for c in self.sources if c.topic == names[topics.RAW_BLOCK]} if not imu else set()
        self._imu, self._blocks = imu, blocks
        if imu:
            self._output = bag.topic(topics.in_bag(topics.COMPENSATED), types.IMU)
        else:
            self._output = bag.topic(topics.in_bag(topics.COMPENSATED_BLOCK), types.ACCEL_BLOCK)
        self._state = bag.topic(topics.in_bag(topics.STATE), types.STATE)
        self._sample = self._row = 0

    def take(self, connection: Connection, time: int, raw: bytes) -> None:
        """Write a message of the source, and its outputs if it is an accelerometer's."""
        self._bag.write_raw(self._copies[connection.id], time, raw)
        if connection.id in self._imu:
            self._compensate(time, self._reader.deserialize(raw, connection.msgtype), 1)
        elif connection.id in self._blocks:
            message: Any = self._reader.deserialize(raw, connection.msgtype)
            self._compensate(time, message, len(message.x))

    def _compensate(self, time: int, message: Any, count: int) -> None:
        usable = bool(self._usable[self._sample : self._sample + count].all())
        rows = slice(self._row, self._row + int(self._usable[self._sample : self._sample + count].sum()))
        self._sample, self._row = self._sample + count, rows.stop
        if not usable or not count:
            return
        values = self._result.values[rows]
        if self._imu:
            patch_imu(message, self._calibration.names, values[0].tolist())
            patch_covariances(message, self._calibration.names, self._result.added_variance(rows.start))
        else:
            patch_block(message, self._calibration.names, values)
        self._bag.write(self._output, time, message)
        fields = state_fields(self._calibration, self._result, rows.stop - 1)
        state = self._bag.typestore.types[types.STATE]
        self._bag.write(self._state, time, state(header=message.header, **fields))
