"""Figures of samples that come in parts: of all of them up to a number that waits on the disk, else of what went by."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from math import fsum

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.evaluation.allan import LEAST_CLUSTERS, AllanCurve, curve_in_place, median_step
from hgma_compensation.evaluation.allan_pyramid import AllanPyramid
from hgma_compensation.evaluation.evaluate import MEAN_SECONDS, Evaluation, Means, evaluation_of, measures
from hgma_compensation.recording.spooled import Spooled
from hgma_compensation.stamps import Stamps, seconds_between
from hgma_compensation.training.blocks import GroupSums
from hgma_compensation.training.reference import Reference

Array = NDArray[np.float64]

WHOLE = 1 << 20
"""Samples that wait, three hours at 100 Hz. Of more the Allan deviation is an estimate, the mean a sum of parts."""

AT_ONCE = 1 << 13
"""Samples that are looked at together once there are more."""


@dataclass(frozen=True)
class Part:
    """stamps: (n,) ns. raw, compensated: (n, c) samples. temperature: (n,) °C."""

    stamps: Stamps
    raw: Array
    compensated: Array
    temperature: Array

    def within(self, span: tuple[int, int]) -> Part:
        """Return the samples with stamps (ns) from the first to before the second."""
        rows = (self.stamps >= span[0]) & (self.stamps < span[1])
        return Part(self.stamps[rows], self.raw[rows], self.compensated[rows], self.temperature[rows])


class LongEvaluation:
    """Takes the samples of one recording in their order. samples: how many there were."""

    def __init__(self, calibration: Calibration, reference: Reference) -> None:
        """Judge with a calibration that the samples were compensated with."""
        self._calibration, self._reference = calibration, reference
        self._width = 2 * len(calibration.names)
        self._sums = GroupSums(2 + self._width)
        self._start: int | None = None
        self._noise: _Waiting | _Passing = _Waiting(self._width)
        self.samples = 0

    def add(self, part: Part) -> None:
        """Take samples; raises RefusedError where there is no room for temporary files."""
        if not len(part.stamps):
            return
        if self._start is None:
            self._start = int(part.stamps[0])
        values = np.concatenate([part.raw, part.compensated], axis=1)
        time = seconds_between(part.stamps, self._start)
        index = np.floor(time / MEAN_SECONDS).astype(np.int64)
        self._sums.add(index, np.column_stack([time, part.temperature, values]))
        self.samples += len(values)
        if isinstance(self._noise, _Waiting) and self.samples > WHOLE:
            self._noise = _Passing.after(self._noise, self._width)
        self._noise.add(part.stamps, values)

    def evaluation(self) -> Evaluation:
        """Return the figures of all samples; there must be some."""
        means, curves = self._noise.means_and_curves()
        names = self._calibration.names
        raw, compensated = np.split(means, 2)
        references = [self._reference.beside(names, partial(np.asarray, own)) for own in (raw, compensated)]
        return evaluation_of(
            self._calibration,
            Means(self._sums.means(), np.concatenate(references)),
            lambda column, error: measures(curves[column], error, self.samples),
        )


class _Waiting:
    """Samples that wait for the last one."""

    def __init__(self, width: int) -> None:
        self._steps, self._values, self._width = Spooled(1, np.int64), Spooled(width), width
        self._last: Stamps = np.empty(0, dtype=np.int64)

    def add(self, stamps: Stamps, values: Array) -> None:
        self._steps.add(np.diff(stamps, prepend=self._last)[:, None])
        self._values.add(values)
        self._last = stamps[-1:].copy()

    def interval(self, most: int | None = None) -> float:
        """Return the median time (s) from one sample to the next, of the first ``most``."""
        return median_step(self._steps.column(0, most))

    def parts(self) -> Iterator[Array]:
        return self._values.parts()

    def means_and_curves(self) -> tuple[Array, list[AllanCurve | None]]:
        """Return the mean (width,) and the Allan curve of each column, one after the other in memory."""
        interval, means, curves = self.interval(), np.empty(self._width), []
        for column in range(self._width):
            values = self._values.column(column)
            means[column] = np.mean(values)
            curves.append(curve_in_place(interval, values))
        return means, curves


class _Passing:
    """What is kept of samples that are not."""

    def __init__(self, width: int, interval: float) -> None:
        self._interval, self._allan = interval, AllanPyramid(width)
        self._totals: list[list[float]] = [[] for _ in range(width)]
        self._held: list[Array] = []
        self._count = 0

    @classmethod
    def after(cls, waiting: _Waiting, width: int) -> _Passing:
        """Let go of samples that wait."""
        passing = cls(width, waiting.interval(AT_ONCE))
        for values in waiting.parts():
            passing._take(values)
        return passing

    def add(self, stamps: Stamps, values: Array) -> None:
        self._held.append(values)
        self._count += len(values)
        if self._count > AT_ONCE:
            self._pass()

    def _pass(self) -> None:
        if self._held:
            values = np.concatenate(self._held)
            self._held, self._count = [], 0
            for start in range(0, len(values), AT_ONCE):
                self._take(values[start : start + AT_ONCE])

    def _take(self, values: Array) -> None:
        for column, totals in zip(values.T, self._totals, strict=True):
            totals.append(float(column.sum()))
        self._allan.add(values)

    def means_and_curves(self) -> tuple[Array, list[AllanCurve | None]]:
        """Return the mean (width,) and the Allan curve of each column."""
        self._pass()
        count = self._allan.samples
        factors, deviations = self._allan.deviations(count // LEAST_CLUSTERS)
        taus = np.asarray(factors * self._interval, dtype=np.float64)
        curves = [AllanCurve(taus, own) if self._interval > 0.0 else None for own in deviations.T]
        return np.array([fsum(totals) / count for totals in self._totals]), curves
