"""Compensates a recording in memory, and says whether one has what a calibration needs."""

from collections.abc import Iterator
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from hgma_compensation import topics
from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.channels import columns_of
from hgma_compensation.effects.effect import Effect, Need
from hgma_compensation.effects.stage import channels_read
from hgma_compensation.errors import RefusedError
from hgma_compensation.pipeline.compensated import Compensated
from hgma_compensation.pipeline.pipeline import CHUNK, Pipeline
from hgma_compensation.pipeline.screening import usable_samples
from hgma_compensation.recording.recording import Recording
from hgma_compensation.recording.sliced import Sampled, in_parts


class Covered(Protocol):
    """What ``check_covered`` asks of a recording."""

    @property
    def name(self) -> str:
        """Name, for messages."""

    @property
    def present(self) -> tuple[str, ...]:
        """The channels that carry something."""

    def require_temperature(self) -> None:
        """Raise RefusedError where there is no thermistor."""

    def has(self, name: str) -> bool:
        """Return whether there is a finite sample of a slow input, named as the field of Recording."""


def usable_rows(recording: Sampled, calibration: Calibration) -> NDArray[np.bool_]:
    """Return for each sample whether it is compensated; as in the node, one that is not costs its whole block."""
    return np.concatenate(
        [np.empty(0, dtype=np.bool_), *(usable for _, usable in usable_parts(recording, calibration))]
    )


def usable_parts(recording: Sampled, calibration: Calibration) -> Iterator[tuple[slice, NDArray[np.bool_]]]:
    """Yield the same for CHUNK samples at a time, and which they are."""
    columns, spoilt = columns_of(calibration.channels_read), np.empty(0, dtype=np.int64)

    def usable(part: slice) -> NDArray[np.bool_]:
        return usable_samples(recording.stamps[part], recording.values[part][:, columns])

    if recording.block is not None:
        bad = [recording.block[part][~usable(part)] for part in in_parts(recording.samples, CHUNK)]
        spoilt = np.unique(np.concatenate([spoilt, *(np.unique(blocks) for blocks in bad)]))
    for part in in_parts(recording.samples, CHUNK):
        whole = usable(part)
        yield part, whole if recording.block is None else whole & ~np.isin(recording.block[part], spoilt)


def check_covered(recording: Covered, calibration: Calibration) -> None:
    """Raise RefusedError where the recording lacks an input or a channel that the calibration needs."""
    recording.require_temperature()
    missing = [name for name in calibration.names if name not in recording.present]
    if missing:
        raise RefusedError(
            f"{recording.name} has no channel {', '.join(missing)}, which the calibration covers: give a recording "
            "that has it, or train with --channels on what there is"
        )
    for applied in calibration.effects:
        _check_effect(recording, applied.effect)


def _check_effect(recording: Covered, effect: Effect) -> None:
    wanted = f"which the effect {effect.name} of the calibration needs"
    for need, topic in ((Need.TEMPERATURE_2, topics.TEMPERATURE_2), (Need.SUPPLY_VOLTAGE, topics.SUPPLY_VOLTAGE)):
        if need in effect.needs and not recording.has(need.value):
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
    return pipeline.compensate(recording.stamps[rows], pipeline.columns.of(values), values)


def feed(pipeline: Pipeline, recording: Sampled) -> None:
    """Give a pipeline the thermometers and the supply voltage of a recording."""
    inputs = (
        (pipeline.add_temperature, recording.temperature),
        (pipeline.add_temperature_2, recording.temperature_2),
        (pipeline.add_supply_voltage, recording.supply_voltage),
    )
    for add, series in inputs:
        for part in in_parts(len(series.stamps), CHUNK):
            for stamp, value in zip(series.stamps[part].tolist(), series.values[part].tolist(), strict=True):
                add(stamp, value)
