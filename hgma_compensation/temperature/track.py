"""A thermometer's history as the trend filter saw it."""

from collections import Counter
from collections.abc import Iterable
from enum import Enum
from math import inf, isfinite
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.effects.memory import TemperatureMemory
from hgma_compensation.stamps import Stamps, to_nanoseconds
from hgma_compensation.temperature.plausibility import Plausibility, Verdict
from hgma_compensation.temperature.trend_filter import TrendFilter, TrendNoise
from hgma_compensation.temperature.updates import Array, Updates
from hgma_compensation.time_jumps import TIME_JUMP, StepBack

PLAUSIBLE_CELSIUS = (-100.0, 250.0)
"""Outside of this a thermistor is broken or speaks another unit: no silicon sensor lives there."""


class Sample(Enum):
    """What became of one thermistor sample; the value is its name in the diagnostics.

    USED and the four after it: it was used. RESTARTED: after all before it was forgotten. SET_BACK: after the history
    was moved to the corrected clock. RECALLED: after the samples of a clock that was wrong were forgotten. MOVED: as
    the first to be believed after a jump. STUCK: though it does not look like a measurement.
    """

    USED = "used"
    RESTARTED = "temperature_time_jumped_back"
    SET_BACK = "temperature_clock_set_back"
    RECALLED = "temperature_clock_was_ahead"
    MOVED = "temperature_moved"
    STUCK = "temperature_stuck"
    NOT_STAMPED = "temperature_not_stamped"
    REPEATED = "temperature_stamp_repeated"
    OUT_OF_ORDER = "temperature_out_of_order"
    NOT_FINITE = "temperature_not_finite"
    IMPLAUSIBLE = "temperature_implausible"
    JUMPED = "temperature_jumped"


TAKEN = frozenset((Sample.USED, Sample.RESTARTED, Sample.SET_BACK, Sample.RECALLED, Sample.MOVED, Sample.STUCK))
"""Outcomes of samples that were used."""

_STEPS_BACK = {StepBack.ANEW: Sample.RESTARTED, StepBack.CORRECTED: Sample.SET_BACK, None: Sample.RECALLED}


def judge(stamp: int, value: float, plausible: tuple[float, float], updates: Updates) -> Sample:
    """Say, from its stamp (ns) and whether it lies in the plausible range, what becomes of a sample."""
    if stamp <= 0:
        return Sample.NOT_STAMPED
    if not isfinite(value):
        return Sample.NOT_FINITE
    if not plausible[0] <= value <= plausible[1]:
        return Sample.IMPLAUSIBLE
    last = updates.last
    if last is None or stamp > last:
        return Sample.USED
    meaning = updates.step_back(stamp)
    if meaning is StepBack.LATE:
        return Sample.REPEATED if stamp == last else Sample.OUT_OF_ORDER
    return _STEPS_BACK[meaning]


def turn_back(outcome: Sample, stamp: int, updates: Updates) -> None:
    """Prepare the updates for a sample (stamp in ns) after a step back; nothing after other outcomes."""
    if outcome is Sample.RESTARTED:
        updates.reset()
    elif outcome is Sample.SET_BACK:
        updates.set_back(stamp)
    elif outcome is Sample.RECALLED:
        updates.recall()


_VERDICTS = {Verdict.MOVED: Sample.MOVED, Verdict.STUCK: Sample.STUCK}


class TemperatureTrack:
    """The trend filter, which starts anew at each power-on, and the updates that it makes out of samples."""

    def __init__(
        self,
        noise: TrendNoise,
        *,
        memory: TemperatureMemory | None = None,
        limits: tuple[float, float] = (-inf, inf),
        keep: float | None = None,
    ) -> None:
        """Start empty; memory, limits (°C): see Updates. keep: s of history to hold on to, None for all of it."""
        self._filter = TrendFilter(noise)
        self._before_gap: list[float] = []
        self._plausibility = Plausibility(noise)
        self.updates = Updates(memory, limits=limits, keep=None if keep is None else to_nanoseconds(keep))
        self.counts: Counter[Sample] = Counter()

    def reset(self) -> None:
        """Forget all samples; the counts stay."""
        self._filter.reset()
        self._plausibility.reset()
        self.updates.reset()

    def unchanged(self, stamp: int) -> float:
        """Return for how long (s), at a stamp in ns, the samples have had exactly the same value."""
        return self._plausibility.unchanged(stamp)

    @property
    def first(self) -> int | None:
        """Stamp of the first update, ns."""
        return self.updates.first

    @property
    def first_temperature(self) -> float:
        """Temperature of the first update, °C."""
        return self.updates.first_temperature

    @property
    def last(self) -> int | None:
        """Stamp of the newest update, ns."""
        return self.updates.last

    def read(
        self, stamps: Stamps, latency: int, horizon: float, as_of: Stamps | None = None
    ) -> tuple[Array, Array, Array]:
        """Return T (°C), Ṫ (°C/s) and age (s), each (n,): see Updates."""
        return self.updates.read(stamps, latency, horizon, as_of)

    def read_earlier(
        self, stamps: Stamps, back: int, latency: int, horizon: float, as_of: Stamps | None = None
    ) -> Array:
        """Return T (n,), °C, ``back`` ns before stamps: see Updates."""
        return self.updates.read_earlier(stamps, back, latency, horizon, as_of)

    def since_power_on(self, stamps: Stamps, latency: int, as_of: Stamps | None = None) -> Array:
        """Return the time since the power-on (n,) in s: see Updates."""
        return self.updates.since_power_on(stamps, latency, as_of)

    def last_is_unusable(self, stamps: Stamps, latency: int) -> NDArray[np.bool_]:
        """Return (n,) whether the newest sample could not be used: see Updates."""
        return self.updates.last_is_unusable(stamps, latency)

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
        outcome = judge(stamp, celsius, PLAUSIBLE_CELSIUS, self.updates)
        if outcome not in TAKEN:
            if outcome in (Sample.NOT_FINITE, Sample.IMPLAUSIBLE):
                self.updates.unusable.note(stamp)
            return outcome
        self._turn_back(outcome, stamp)
        verdict = self._plausibility.judge(stamp, celsius)
        if verdict in (Verdict.JUMPED, Verdict.STUCK):
            self.updates.unusable.note(stamp)
        if verdict is Verdict.JUMPED:
            return Sample.JUMPED
        self._use(stamp, celsius, moved=verdict is Verdict.MOVED)
        return _VERDICTS.get(verdict, outcome)

    def _turn_back(self, outcome: Sample, stamp: int) -> None:
        turn_back(outcome, stamp, self.updates)
        if outcome is Sample.RESTARTED:
            self._filter.reset()
        elif outcome is Sample.RECALLED:
            self._filter.restore(self._before_gap)
        if outcome is not Sample.USED:
            self._plausibility.reset()

    def _use(self, stamp: int, celsius: float, *, moved: bool) -> None:
        last = self.last
        if last is not None and stamp - last > TIME_JUMP:
            self._before_gap = self._filter.snapshot()
        if self.updates.is_power_on(stamp):
            # Ṫ of the time before says nothing about what the sensor did while it was off.
            self._filter.reset()
        if moved:
            self._filter.reset()
        step = self._filter.step(0.0 if last is None else (stamp - last) * 1e-9, celsius)
        self.updates.append(stamp, step.temperature, step.rate)

    def snapshot(self, reach: float) -> dict[str, Any]:
        """Return, as plain JSON, the filter's state and the updates that readings within ``reach`` s depend on."""
        return {"filter": self._filter.snapshot(), "updates": self.updates.snapshot(to_nanoseconds(reach))}

    def restore(self, snapshot: dict[str, Any]) -> None:
        """Go on from a snapshot of a track with the same noise and memory; raises ValueError where it does not fit."""
        self._plausibility.reset()
        self.updates.restore(snapshot["updates"])
        self._filter.restore(snapshot["filter"])
