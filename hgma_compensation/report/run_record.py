"""What a report says of a run beyond its errors, gathered while the samples go by, in bounded memory."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.evaluation.allan import FEWEST_SAMPLES, LEAST_CLUSTERS, AllanCurve, median_interval
from hgma_compensation.evaluation.allan_pyramid import AllanPyramid
from hgma_compensation.evaluation.long_evaluation import Part
from hgma_compensation.pipeline.compensated import Compensated
from hgma_compensation.pipeline.status import TemperatureStatus

AT_ONCE = 1 << 16
"""Samples that the Allan deviation takes together: few at a time cost as much."""


@dataclass(frozen=True)
class RunSummary:
    """A recording as the pipeline saw it.

    start, end: stamps of the first and the last sample, ns. interval: median time between samples, s. statuses: number
    of samples of each TemperatureStatus. outside: samples outside of the calibrated range. curves: of each channel,
    raw and compensated; None for too few samples.
    """

    start: int
    end: int
    interval: float
    samples: int
    statuses: dict[TemperatureStatus, int]
    outside: int
    curves: tuple[tuple[AllanCurve, AllanCurve] | None, ...]

    @property
    def duration(self) -> float:
        """Time from the first to the last sample, s."""
        return (self.end - self.start) * 1e-9


class RunRecord:
    """Takes the samples of one recording in their order."""

    def __init__(self, channels: int) -> None:
        """Start without samples of so many channels."""
        self._channels = channels
        self._allan = AllanPyramid(2 * channels)
        self._waiting: list[NDArray[np.float64]] = []
        self._statuses = np.zeros(len(TemperatureStatus), dtype=np.int64)
        self._samples = self._outside = self._count = 0
        self._start = self._end = 0
        self._interval = 0.0

    def add(self, part: Part, result: Compensated) -> None:
        """Take samples, at least one, and what the pipeline made of them."""
        first, last = int(part.stamps.min()), int(part.stamps.max())
        self._start = min(self._start, first) if self._samples else first
        self._end = max(self._end, last) if self._samples else last
        self._interval = self._interval or median_interval(part.stamps)
        self._samples += len(part.stamps)
        self._statuses += np.bincount(result.status, minlength=len(TemperatureStatus))
        self._outside += int(np.count_nonzero(~result.inside_range))
        self._waiting.append(np.concatenate([part.raw, part.compensated], axis=1))
        self._count += len(part.stamps)
        if self._count >= AT_ONCE:
            self._pass()

    def _pass(self) -> None:
        if self._waiting:
            self._allan.add(np.concatenate(self._waiting))
        self._waiting, self._count = [], 0

    def summary(self) -> RunSummary:
        """Return what was gathered."""
        self._pass()
        statuses = {status: int(self._statuses[status]) for status in TemperatureStatus if self._statuses[status]}
        return RunSummary(
            self._start, self._end, self._interval, self._samples, statuses, self._outside, self._curves()
        )

    def _curves(self) -> tuple[tuple[AllanCurve, AllanCurve] | None, ...]:
        if self._samples < FEWEST_SAMPLES or self._interval <= 0.0:
            return (None,) * self._channels
        factors, deviations = self._allan.deviations(self._samples // LEAST_CLUSTERS)
        taus = np.asarray(factors * self._interval, dtype=np.float64)
        return tuple(
            (AllanCurve(taus, deviations[:, column]), AllanCurve(taus, deviations[:, self._channels + column]))
            for column in range(self._channels)
        )
