"""The thermistor's history as the trend filter saw it, readable at any stamp.

A reading at stamp t uses the newest update whose stamp is at most t - latency and predicts from it.
It depends on stamps alone, never on the order in which messages arrived, so a batch and a stream
give the same bits as long as a thermistor sample arrives within the latency. Only the first sample
is used from its own stamp on: until there is a second, it is all that is known.
"""

from collections import Counter
from collections.abc import Iterable
from enum import Enum
from math import isfinite

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.stamps import NANOSECONDS, Stamps, seconds_between, to_nanoseconds
from hgma_compensation.temperature.trend_filter import TrendFilter, TrendNoise

PLAUSIBLE_CELSIUS = (-100.0, 250.0)
"""Outside of this a thermistor is broken or speaks another unit: no silicon sensor lives there."""

TIME_JUMP = 5 * NANOSECONDS
"""A step back by more than this is a new beginning (a bag that loops), by less a late message."""


class Sample(Enum):
    """What became of one thermistor sample; the value is its name in the diagnostics."""

    USED = "used"
    RESTARTED = "temperature_time_jumped_back"
    REPEATED = "temperature_stamp_repeated"
    OUT_OF_ORDER = "temperature_out_of_order"
    NOT_FINITE = "temperature_not_finite"
    IMPLAUSIBLE = "temperature_implausible"


class TemperatureTrack:
    """Updates of the trend filter, appended in the order of their stamps."""

    def __init__(self, noise: TrendNoise, *, keep: float | None = None) -> None:
        """Start empty; keep: s of history that a stream must hold on to, None for all of it."""
        self._filter = TrendFilter(noise)
        self._keep = None if keep is None else to_nanoseconds(keep)
        self.counts: Counter[Sample] = Counter()
        self.reset()

    def reset(self) -> None:
        """Forget all samples; the counts stay."""
        self._filter.reset()
        self._stamps = np.empty(256, dtype=np.int64)
        self._estimates = np.empty((256, 2))
        self._size = 0
        self.first: int | None = None
        self.first_temperature = 0.0

    @property
    def last(self) -> int | None:
        """Stamp of the newest update, ns."""
        return int(self._stamps[self._size - 1]) if self._size else None

    def add(self, stamp: int, celsius: float) -> Sample:
        """Take one thermistor sample (stamp in ns, °C) and say what became of it."""
        sample = self._take(stamp, celsius)
        self.counts[sample] += 1
        return sample

    def extend(self, stamps: Iterable[int], celsius: Iterable[float]) -> None:
        """Take many samples, as ``add`` would one after the other."""
        for stamp, value in zip(stamps, celsius, strict=True):
            self.add(int(stamp), float(value))

    def _take(self, stamp: int, celsius: float) -> Sample:
        if not isfinite(celsius):
            return Sample.NOT_FINITE
        if not PLAUSIBLE_CELSIUS[0] <= celsius <= PLAUSIBLE_CELSIUS[1]:
            return Sample.IMPLAUSIBLE
        outcome = Sample.USED
        last = self.last
        if last is not None and stamp <= last:
            if last - stamp <= TIME_JUMP:
                return Sample.REPEATED if stamp == last else Sample.OUT_OF_ORDER
            self.reset()
            last, outcome = None, Sample.RESTARTED
        step = self._filter.step(0.0 if last is None else (stamp - last) * 1e-9, celsius)
        if self.first is None:
            self.first, self.first_temperature = stamp, step.temperature
        self._append(stamp, step.temperature, step.rate)
        return outcome

    def _append(self, stamp: int, temperature: float, rate: float) -> None:
        if self._size == len(self._stamps):
            self._make_room(stamp)
        self._stamps[self._size] = stamp
        self._estimates[self._size] = temperature, rate
        self._size += 1

    def _make_room(self, newest: int) -> None:
        """Drop what is older than the history to keep; grow only if that frees less than half."""
        drop = 0
        if self._keep is not None:
            # One update older than the window stays: readings inside it are predicted from it.
            drop = max(0, int(np.searchsorted(self._stamps, newest - self._keep, side="right")) - 1)
        kept = self._size - drop
        capacity = len(self._stamps) if 2 * kept <= self._size else 2 * len(self._stamps)
        stamps, estimates = np.empty(capacity, dtype=np.int64), np.empty((capacity, 2))
        stamps[:kept], estimates[:kept] = self._stamps[drop : self._size], self._estimates[drop : self._size]
        self._stamps, self._estimates, self._size = stamps, estimates, kept

    def read(
        self, stamps: Stamps, latency: int, horizon: float
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Return T (°C), Ṫ (°C/s) and the age (s) of the update they come from, each of shape (n,).

        stamps: ns. latency: ns that an update must be older than a stamp to be used; the first update
        is used from its own stamp on. horizon: s over which Ṫ is extrapolated; an older update is held.
        Before the first update, T is that of the first one (steady before the start), Ṫ is 0 and the
        age infinite.
        """
        if not self._size:
            return np.full(len(stamps), np.nan), np.zeros(len(stamps)), np.full(len(stamps), np.inf)
        index = np.searchsorted(self._stamps[: self._size], stamps - latency, side="right") - 1
        index = np.maximum(index, 0)
        before = stamps < self._stamps[0]
        age = seconds_between(stamps, self._stamps[index])
        temperature, rate = self._estimates[index, 0], self._estimates[index, 1]
        predicted = temperature + rate * np.minimum(age, horizon)
        return (
            np.where(before, self.first_temperature, predicted),
            np.where(before, 0.0, rate),
            np.where(before, np.inf, age),
        )
