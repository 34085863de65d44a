"""Recordings reduced to means over blocks of time: what drift models are fitted to and judged on."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.channels import columns_of
from hgma_compensation.errors import RefusedError
from hgma_compensation.pipeline.screening import usable_samples
from hgma_compensation.recording.source import Source
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
    recordings: Sequence[Source], channels: Sequence[str], settings: FeatureSettings, seconds: float
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
    recording: Source, number: int, channels: Sequence[str], settings: FeatureSettings, seconds: float
) -> Blocks:
    recording.require_temperature()
    track = TemperatureTrack(settings.noise)
    track.extend(recording.temperature.stamps, recording.temperature.values)
    sums = GroupSums(4 + len(channels))
    for stamps, samples in recording.windows():
        features = read_features(track, settings, stamps)
        values = samples[:, columns_of(channels)]
        usable = (
            (features.since_power_on >= settings.prediction_horizon)
            & (features.age <= settings.prediction_horizon)
            & ~features.unusable
            & usable_samples(stamps, values)
        )
        time = seconds_between(stamps, recording.start)[usable]
        index = np.floor(time / seconds).astype(np.int64)
        sums.add(index, np.column_stack([time, features.values[usable], values[usable]]))
    means = sums.means()
    return Blocks(means[:, 0], np.full(len(means), number), means[:, 1:4], means[:, 4:])


def group_means(index: NDArray[np.int64], columns: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the means of columns (n, k) over equal values of index (n,), in increasing order of it."""
    sums = GroupSums(columns.shape[1])
    sums.add(index, columns)
    return sums.means()


_Groups = tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]]
"""Index, number of rows and sums of groups."""


class GroupSums:
    """Sums of columns over equal values of an index, of rows that come in parts; the parts change no bit of them."""

    def __init__(self, width: int) -> None:
        """Start without rows of so many columns."""
        self._closed: list[_Groups] = []
        self._open: _Groups = (np.empty(0, dtype=np.int64), np.empty(0, dtype=np.int64), np.empty((0, width)))

    def add(self, index: NDArray[np.int64], columns: NDArray[np.float64]) -> None:
        """Take rows (n, k) of an index (n,)."""
        if not len(index):
            return
        if len(self._open[0]) and index.min() < self._open[0][-1]:
            self._open = self._all()  # a time that steps back: its groups may be any
            self._closed = []
        known, counted, summed = self._open
        groups, inverse, counts = np.unique(np.concatenate([known, index]), return_inverse=True, return_counts=True)
        counts[np.searchsorted(groups, known)] += counted - 1
        # What there was of a group is the first that is added: the order of summation is that of the rows.
        sums = [
            np.bincount(inverse, weights=np.concatenate([summed[:, k], columns[:, k]]), minlength=len(groups))
            for k in range(columns.shape[1])
        ]
        whole = np.stack(sums, axis=1).astype(np.float64, copy=False)
        self._closed.append((groups[:-1], counts[:-1], whole[:-1]))
        self._open = groups[-1:], counts[-1:], whole[-1:]

    def _all(self) -> _Groups:
        parts = [*self._closed, self._open]
        index, counts, sums = (np.concatenate([part[k] for part in parts]) for k in range(3))
        return index, counts, sums

    def means(self) -> NDArray[np.float64]:
        """Return the means (groups, k) in increasing order of the index."""
        _, counts, sums = self._all()
        return np.asarray(sums / counts[:, None])


def noise_of_means(values: NDArray[np.float64]) -> float:
    """Return the white noise of a series (n,) from its second differences, which no slow drift enters."""
    if len(values) < 3:
        return 0.0
    return white_noise(float(np.median(np.abs(np.diff(values, 2)))))


def white_noise(median: float) -> float:
    """Return the white noise of a series whose second differences have that median magnitude."""
    # The median is deaf to shocks and steps; 6 is the gain of the second difference for white noise.
    return float(median / 0.6745 / np.sqrt(6.0))
