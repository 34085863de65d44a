"""What the slow inputs say of each sample: read off the lines of its cell, only where it is asked for."""

from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.drift.model import CalibratedRange
from hgma_compensation.pipeline.cell_values import CellValues, Line
from hgma_compensation.pipeline.cells import Places
from hgma_compensation.pipeline.status import temperature_status
from hgma_compensation.pipeline.uncertainty import DriftUncertainty
from hgma_compensation.stamps import Stamps, seconds_between
from hgma_compensation.temperature.features import Features, FeatureSettings

Array = NDArray[np.float64]

FEW = 64
"""Samples up to which all columns of a row are computed at once, and column by column beyond."""


class SlowSamples:
    """n samples in m cells; every array is computed at its first use."""

    def __init__(
        self,
        stamps: Stamps,
        cells: CellValues,
        places: Places,
        settings: FeatureSettings,
        box: CalibratedRange,
        uncertainty: DriftUncertainty,
    ) -> None:
        """Take samples at stamps (n,) in ns with their cells."""
        self._stamps, self._cells, self._places = stamps, cells, places
        self._settings, self._box, self._uncertainty = settings, box, uncertainty
        self.ordinary = cells.ordinary

    def take(self, rows: NDArray[np.int64]) -> "SlowSamples":
        """Return what is said of some of the samples (k,), the same bits, for the price of these."""
        stamps, places = self._stamps[rows], self._places.take(rows)
        return SlowSamples(stamps, self._cells, places, self._settings, self._box, self._uncertainty)

    def __len__(self) -> int:
        """Return n."""
        return len(self._stamps)

    @cached_property
    def _way(self) -> Array:
        """How far each sample is on the way through its cell, (n,), 0 to 1."""
        cells = self._cells
        if self._places.index is None:
            return (self._stamps - cells.begin[0]) * float(cells.inverse[0])
        return np.asarray((self._stamps - self._spread(cells.begin)) * self._spread(cells.inverse))

    def _spread(self, column: NDArray[Any]) -> NDArray[Any]:
        """Return what holds in the cells (m,) for each sample, (n,) or (1,)."""
        if self._places.index is None:
            return column
        if self._places.counts is not None:
            return np.repeat(column, self._places.counts)
        return column[self._places.index]

    def _each(self, column: NDArray[Any]) -> NDArray[Any]:
        """Return what holds in the cells (m,) for each sample, (n,)."""
        return np.repeat(column, len(self)) if self._places.index is None else self._spread(column)

    def _along(self, line: Line) -> Array:
        """Return the values (n, k) on lines."""
        way = self._way
        if self._places.index is None and len(self) <= FEW:
            return np.asarray(line.first + way[:, None] * line.change)
        values = np.empty((line.first.shape[1], len(self)))
        if self._places.index is None:
            for row, first, change in zip(values, line.first[0].tolist(), line.change[0].tolist(), strict=True):
                np.multiply(way, change, out=row)
                row += first
            return values.T
        for row, first, change in zip(values, line.first.T, line.change.T, strict=True):
            np.multiply(way, self._spread(change), out=row)
            row += self._spread(first)
        return values.T

    @cached_property
    def model(self) -> Array:
        """Drift (n, c) of the drift model alone."""
        return self._along(self._cells.model)

    @property
    def effects(self) -> Array:
        """Drift (n, c) of the slow effects, in memory of its own."""
        line = self._cells.effects
        return np.zeros((self._cells.model.first.shape[1], len(self))).T if line is None else self._along(line)

    @cached_property
    def drift(self) -> Array:
        """Drift (n, c) of drift model and slow effects."""
        return self.model if self._cells.drift is self._cells.model else self._along(self._cells.drift)

    def taken_from(self, values: Array) -> Array:
        """Return values (n, c) less the drift; for a block in one cell without an array of the drift itself."""
        if self._places.index is not None or len(self) <= FEW:
            return values - self.drift
        line = self._cells.drift
        left = np.empty((values.shape[1], len(self)))
        for row, column, first, change in zip(
            left, values.T, line.first[0].tolist(), line.change[0].tolist(), strict=True
        ):
            np.multiply(self._way, change, out=row)
            row += first
            np.subtract(column, row, out=row)
        return left.T

    @cached_property
    def features(self) -> Array:
        """Features (n, 3) before clamping; the middle of the calibrated range where the temperature is missing."""
        return self._along(self._cells.features)

    @cached_property
    def clamped(self) -> Array:
        """Features (n, 3) inside the calibrated range."""
        return self._box.clamp(self.features)

    @cached_property
    def unknown(self) -> NDArray[np.bool_]:
        """Whether the temperature is missing, (n,)."""
        return np.asarray(self._each(self._cells.missing), dtype=np.bool_)

    @cached_property
    def _age(self) -> Array:
        begin = seconds_between(self._stamps, np.asarray(self._spread(self._cells.begin), dtype=np.int64))
        return np.asarray(self._spread(self._cells.age) + begin)

    @cached_property
    def since_power_on(self) -> Array:
        """Time since the power-on (n,) in s."""
        begin = seconds_between(self._stamps, np.asarray(self._spread(self._cells.begin), dtype=np.int64))
        return np.asarray(self._spread(self._cells.since_power_on) + begin)

    @cached_property
    def _judged(self) -> tuple[NDArray[np.uint8], NDArray[np.bool_]]:
        """Status and whether the features lie in the calibrated range, (n,) each."""
        status, inside = self._each(self._cells.status), self._each(self._cells.inside)
        if self._cells.mixed.any():
            mixed = self._each(self._cells.mixed)
            looked_at = self._box.contains(self.features)
            features = Features(
                self.features,
                self._age,
                self.since_power_on,
                np.asarray(self._each(self._cells.unusable), dtype=np.bool_),
            )
            inside = np.where(mixed, looked_at, inside)
            status = np.where(mixed, temperature_status(features, self._settings, looked_at), status)
        return np.asarray(status, dtype=np.uint8), np.asarray(inside, dtype=np.bool_)

    @property
    def status(self) -> NDArray[np.uint8]:
        """TemperatureStatus (n,)."""
        return self._judged[0]

    @property
    def inside_range(self) -> NDArray[np.bool_]:
        """Whether the features lie in the calibrated range, (n,)."""
        return self._judged[1]

    @cached_property
    def uncertainty(self) -> Array:
        """Standard deviation of the drift, (n, c)."""
        return self._uncertainty.evaluate(self.features, self._age, self.status)
