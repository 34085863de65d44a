"""Recordings reduced to means over blocks of time: what drift models are fitted to and judged on."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.channels import columns_of
from hgma_compensation.errors import RefusedError
from hgma_compensation.pipeline.screening import usable_samples
from hgma_compensation.recording.recording import Recording
from hgma_compensation.stamps import seconds_between
from hgma_compensation.temperature.features import FeatureSettings, read_features
from hgma_compensation.temperature.track import TemperatureTrack


@dataclass(frozen=True)
class Blocks:
    """Means over blocks, in time order within each recording.

    time: (n,) s from the start of its recording. recording: (n,) which one. features: (n, 3).
    values: (n, c) of the channels.
    """

    time: NDArray[np.float64]
    recording: NDArray[np.int64]
    features: NDArray[np.float64]
    values: NDArray[np.float64]

    def select(self, rows: NDArray[np.bool_]) -> "Blocks":
        """Return the blocks of the rows that are true."""
        return Blocks(self.time[rows], self.recording[rows], self.features[rows], self.values[rows])


def block_means(
    recordings: Sequence[Recording], channels: Sequence[str], settings: FeatureSettings, seconds: float
) -> Blocks:
    """Return the means of samples over blocks of the given length (s).

    Samples before the trend filter has settled after a power-on, without a recent thermistor sample, or with one that
    looks broken, are left out. Features are those of the node, causal; before the history since a power-on covers the
    delay of ΔT they assume, as the node does, that the temperature was steady before.
    Raises RefusedError where too little is left to fit anything.
    """
    parts = [_of_recording(r, number, channels, settings, seconds) for number, r in enumerate(recordings)]
    blocks = Blocks(*(np.concatenate([getattr(p, name) for p in parts]) for name in Blocks.__dataclass_fields__))
    if len(blocks.time) < FEWEST:
        raise RefusedError(
            f"{', '.join(r.name for r in recordings)}: {len(blocks.time)} means of {seconds:g} s with a settled "
            f"temperature, at least {FEWEST} are needed: record for longer"
        )
    return blocks


FEWEST = 50
"""Blocks: below this a cross-validated fit of a dozen coefficients says nothing."""


def _of_recording(
    recording: Recording, number: int, channels: Sequence[str], settings: FeatureSettings, seconds: float
) -> Blocks:
    recording.require_temperature()
    track = TemperatureTrack(settings.noise)
    track.extend(recording.temperature.stamps, recording.temperature.values)
    features = read_features(track, settings, recording.stamps)
    values = recording.values[:, columns_of(channels)]
    usable = (
        (features.since_power_on >= settings.prediction_horizon)
        & (features.age <= settings.prediction_horizon)
        & ~features.unusable
        & usable_samples(recording.stamps, values)
    )
    time = seconds_between(recording.stamps, recording.start)[usable]
    index = np.floor(time / seconds).astype(np.int64)
    columns = np.column_stack([time, features.values[usable], values[usable]])
    means = group_means(index, columns)
    return Blocks(means[:, 0], np.full(len(means), number), means[:, 1:4], means[:, 4:])


def group_means(index: NDArray[np.int64], columns: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the means of columns (n, k) over equal values of index (n,), in increasing order of it."""
    _, inverse, counts = np.unique(index, return_inverse=True, return_counts=True)
    sums = np.stack([np.bincount(inverse, weights=column, minlength=len(counts)) for column in columns.T], axis=1)
    return np.asarray(sums / counts[:, None])


def noise_of_means(values: NDArray[np.float64]) -> float:
    """Return the white noise of a series (n,) from its second differences, which no slow drift enters."""
    if len(values) < 3:
        return 0.0
    second = np.diff(values, 2)
    # The median is deaf to shocks and steps; 6 is the gain of the second difference for white noise.
    return float(np.median(np.abs(second)) / 0.6745 / np.sqrt(6.0))
