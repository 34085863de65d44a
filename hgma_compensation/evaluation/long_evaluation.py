"""Figures of samples that come in parts: of all of them where they fit into memory, else of what went by."""

from __future__ import annotations

from dataclasses import dataclass
from math import fsum

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.evaluation.allan import LEAST_CLUSTERS, AllanCurve, median_interval
from hgma_compensation.evaluation.allan_pyramid import AllanPyramid
from hgma_compensation.evaluation.evaluate import (
    MEAN_SECONDS,
    Evaluation,
    Means,
    Measures,
    compare,
    evaluation_of,
    measures,
)
from hgma_compensation.stamps import Stamps, seconds_between
from hgma_compensation.training.blocks import GroupSums
from hgma_compensation.training.reference import Reference

Array = NDArray[np.float64]

WHOLE = 1 << 20
"""Samples that are held, three hours at 100 Hz. Of more the Allan deviation is an estimate, the mean a sum of parts."""

AT_ONCE = 1 << 16
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

    def __init__(self, calibration: Calibration, reference: Reference, expected: int = 0) -> None:
        """Judge with a calibration that the samples were compensated with; expected: how many they are at the least."""
        self._calibration, self._reference = calibration, reference
        self._held: list[Part] = []
        self._count = self.samples = 0
        self._passing: _Passing | None = None
        self._most = AT_ONCE if expected > WHOLE else WHOLE

    def add(self, part: Part) -> None:
        """Take samples."""
        self._held.append(part)
        self._count += len(part.stamps)
        self.samples += len(part.stamps)
        if self._count > self._most:
            self._pass()

    def _pass(self) -> None:
        """Let go of all samples that are held, those of a few parts at a time."""
        while self._held:
            several, count = [self._held.pop(0)], 0
            while self._held and count < AT_ONCE:
                count += len(self._held[0].stamps)
                several.append(self._held.pop(0))
            part = _joined(several)
            if self._passing is None:
                self._passing = _Passing(part, len(self._calibration.names))
            self._passing.add(part)
        self._count, self._most = 0, AT_ONCE

    def evaluation(self) -> Evaluation:
        """Return the figures of all samples; there must be some."""
        if self._passing is None:
            whole = _joined(self._held)
            return compare(
                whole.stamps, whole.raw, whole.compensated, whole.temperature, self._calibration, self._reference
            )
        if self._held:
            self._pass()
        return self._passing.evaluation(self._calibration, self._reference)


def _joined(parts: list[Part]) -> Part:
    return Part(*(np.concatenate([getattr(part, name) for part in parts]) for name in Part.__dataclass_fields__))


class _Passing:
    """What is kept of samples that are not."""

    def __init__(self, first: Part, channels: int) -> None:
        self._channels = channels
        self._start = int(first.stamps[0])
        self._interval = median_interval(first.stamps)
        self._sums = GroupSums(2 + 2 * channels)
        self._allan = AllanPyramid(2 * channels)
        self._totals: list[list[float]] = [[] for _ in range(2 * channels)]

    def add(self, part: Part) -> None:
        values = np.concatenate([part.raw, part.compensated], axis=1)
        for column, totals in zip(values.T, self._totals, strict=True):
            totals.append(float(column.sum()))
        time = seconds_between(part.stamps, self._start)
        index = np.floor(time / MEAN_SECONDS).astype(np.int64)
        self._sums.add(index, np.column_stack([time, part.temperature, values]))
        self._allan.add(values)

    def evaluation(self, calibration: Calibration, reference: Reference) -> Evaluation:
        count = self._allan.samples
        means = np.array([fsum(totals) / count for totals in self._totals])
        raw, compensated = means[: self._channels], means[self._channels :]
        references = np.concatenate(
            [reference.beside(calibration.names, lambda: raw), reference.beside(calibration.names, lambda: compensated)]
        )
        factors, deviations = self._allan.deviations(count // LEAST_CLUSTERS)

        taus = np.asarray(factors * self._interval, dtype=np.float64)

        def figures(column: int, error: Array) -> Measures:
            return measures(AllanCurve(taus, deviations[:, column]) if self._interval > 0.0 else None, error, count)

        return evaluation_of(calibration, Means(self._sums.means(), references), figures)
