"""A thermometer's history as the trend filter saw it."""

from collections import Counter
from collections.abc import Iterable
from enum import Enum
from math import inf, isfinite
from typing import Any

from hgma_compensation.effects.memory import TemperatureMemory
from hgma_compensation.stamps import NANOSECONDS, Stamps, to_nanoseconds
from hgma_compensation.temperature.trend_filter import TrendFilter, TrendNoise
from hgma_compensation.temperature.updates import Array, Updates

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


def judge(stamp: int, value: float, last: int | None) -> Sample:
    """Say what becomes of a sample (stamp in ns) after one at ``last``; RESTARTED: all before it is to be forgotten."""
    if not isfinite(value):
        return Sample.NOT_FINITE
    if last is None or stamp > last:
        return Sample.USED
    if last - stamp > TIME_JUMP:
        return Sample.RESTARTED
    return Sample.REPEATED if stamp == last else Sample.OUT_OF_ORDER


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
        self.updates = Updates(memory, limits=limits, keep=None if keep is None else to_nanoseconds(keep))
        self.counts: Counter[Sample] = Counter()

    def reset(self) -> None:
        """Forget all samples; the counts stay."""
        self._filter.reset()
        self.updates.reset()

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

    def read(self, stamps: Stamps, latency: int, horizon: float) -> tuple[Array, Array, Array]:
        """Return T (°C), Ṫ (°C/s) and age (s), each (n,): see Updates."""
        return self.updates.read(stamps, latency, horizon)

    def read_earlier(self, stamps: Stamps, back: int, latency: int, horizon: float) -> Array:
        """Return T (n,), °C, ``back`` ns before stamps: see Updates."""
        return self.updates.read_earlier(stamps, back, latency, horizon)

    def since_power_on(self, stamps: Stamps, latency: int) -> Array:
        """Return the time since the power-on (n,) in s: see Updates."""
        return self.updates.since_power_on(stamps, latency)

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
        if isfinite(celsius) and not PLAUSIBLE_CELSIUS[0] <= celsius <= PLAUSIBLE_CELSIUS[1]:
            return Sample.IMPLAUSIBLE
        outcome = judge(stamp, celsius, self.last)
        if outcome is Sample.RESTARTED:
            self.reset()
        elif outcome is not Sample.USED:
            return outcome
        last = self.last
        if self.updates.is_power_on(stamp):
            # Ṫ of the time before says nothing about what the sensor did while it was off.
            self._filter.reset()
        step = self._filter.step(0.0 if last is None else (stamp - last) * 1e-9, celsius)
        self.updates.append(stamp, step.temperature, step.rate)
        return outcome

    def snapshot(self, reach: float) -> dict[str, Any]:
        """Return, as plain JSON, the filter's state and the updates that readings within ``reach`` s depend on."""
        return {"filter": self._filter.snapshot(), "updates": self.updates.snapshot(to_nanoseconds(reach))}

    def restore(self, snapshot: dict[str, Any]) -> None:
        """Go on from a snapshot of a track with the same noise and memory; raises ValueError where it does not fit."""
        self.updates.restore(snapshot["updates"])
        self._filter.restore(snapshot["filter"])
