"""What comes beside the acceleration: thermistor, second thermometer, supply voltage; and what effects see of it."""

from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.drift.model import CalibratedRange
from hgma_compensation.effects.conditions import Conditions
from hgma_compensation.effects.effect import Need
from hgma_compensation.effects.stage import EffectStage
from hgma_compensation.pipeline.held_series import HeldSeries
from hgma_compensation.stamps import NANOSECONDS, Stamps, to_nanoseconds
from hgma_compensation.temperature.features import FeatureSettings, Product
from hgma_compensation.temperature.track import Sample, TemperatureTrack
from hgma_compensation.temperature.updates import Updates
from hgma_compensation.time_jumps import TIME_JUMP

Array = NDArray[np.float64]

ACCELERATION_LAG = 60.0
"""Seconds by which a live accelerometer may lag its thermistor before history is dropped."""

_FAR_AHEAD = to_nanoseconds(0.5 * ACCELERATION_LAG)

PLAUSIBLE_VOLTS = (0.0, 100.0)
"""Outside of this a supply voltage is no measurement."""


class Inputs:
    """The slow inputs of one sensor, in any interleaving; what is read at a stamp is decided by stamps.

    wanted: those that are read, None for the thermistor. version: another number once anything has been added or
    forgotten that readings which are held may depend on.
    """

    def __init__(
        self, settings: FeatureSettings, box: CalibratedRange, stage: EffectStage, *, lag: float | None
    ) -> None:
        """Start without history; lag: s that the accelerometer may lag by before history is dropped, None: never."""
        self.version = 0
        self._held: tuple[int, int] | None = None
        self._settings, self._box, self._stage = settings, box, stage
        self._latency = to_nanoseconds(settings.latency)
        delays = {settings.delay} if settings.product is Product.DELAY else set()
        self._delays = [to_nanoseconds(delay) for delay in sorted(delays | stage.delays) if delay > 0.0]
        needs = (Need.TEMPERATURE_2, Need.SUPPLY_VOLTAGE)
        self.wanted: tuple[Need | None, ...] = (None, *(need for need in needs if need in stage.needs))
        history = settings.reach(max(settings.delay, stage.history))
        self._reach = history + ACCELERATION_LAG
        keep = None if lag is None else history + lag
        self.temperature = TemperatureTrack(
            settings.noise, memory=stage.memory, limits=(float(box.lower[0]), float(box.upper[0])), keep=keep
        )
        self.temperature_2 = TemperatureTrack(settings.noise, keep=keep)
        self.supply_voltage = HeldSeries(settings.latency, PLAUSIBLE_VOLTS, keep=keep)

    def reset(self) -> None:
        """Forget all samples."""
        self.version += 1
        for series in (self.temperature, self.temperature_2, self.supply_voltage):
            series.reset()

    def add(self, need: Need | None, stamp: int, value: float) -> Sample:
        """Take a sample of an input, None for the thermistor (ns, °C or V), and say what became of it."""
        series = self._series(need)
        leaves = self._leaves_readings(series.updates, stamp)
        sample = series.add(stamp, value)
        if sample is not Sample.USED or not leaves:
            self.version += 1
        return sample

    def hold(self, begin: int, until: int) -> None:
        """Take note that what was read from ``begin`` to ``until`` (ns) is used again while ``version`` is the same."""
        self._held = begin, until

    @property
    def settled(self) -> int:
        """Stamp in ns before which readings are what they will be, as long as every input only goes on."""
        newest = [self.updates(need).last for need in self.wanted]
        return min((last for last in newest if last is not None), default=0) + self._latency

    def _leaves_readings(self, updates: Updates, stamp: int) -> bool:
        """Return whether a sample at a stamp (ns), if it is used, is too young for any reading that is held."""
        if self._held is None or updates.last is None or updates.is_power_on(stamp):
            return False
        begin, until = self._held
        # One that is far ahead may push out history that readings need.
        return stamp > updates.last and until - self._latency <= stamp <= begin + _FAR_AHEAD

    def updates(self, need: Need | None) -> Updates:
        """Return what became of the samples of an input, None for the thermistor."""
        return self._series(need).updates

    def _series(self, need: Need | None) -> TemperatureTrack | HeldSeries:
        if need is None:
            return self.temperature
        return self.temperature_2 if need is Need.TEMPERATURE_2 else self.supply_voltage

    @property
    def missing(self) -> tuple[Need, ...]:
        """The inputs that an effect needs and that have never come."""
        return tuple(need for need in self.wanted if need is not None and not len(self.updates(need)))

    def changes(self, low: int, high: int) -> Stamps:
        """Return the stamps in low < s < high (ns) from which on readings of any input may use another sample."""
        found = [self.updates(need).changes(low, high, self._latency) for need in self.wanted]
        found += [self.updates(None).changes(low - back, high - back, self._latency) + back for back in self._delays]
        return np.concatenate(found)

    def conditions(
        self,
        stamps: Stamps,
        clamped: Array,
        unknown: NDArray[np.bool_],
        acceleration: Array,
        as_of: Stamps | None = None,
    ) -> Conditions:
        """Return what effects may answer to at n stamps.

        clamped: features (n, 3) inside the calibrated range. unknown: (n,) where the temperature is a guess.
        acceleration: (n, 6), columns CHANNELS. as_of: (n,) ns, as for ``read_features``.
        """
        nothing = np.full(len(stamps), np.nan)
        known = stamps if as_of is None else as_of
        return Conditions(
            stamps=stamps,
            since_power_on=self.temperature.since_power_on(stamps, self._latency, as_of),
            temperature=clamped[:, 0],
            rate=clamped[:, 1],
            earlier=partial(self._earlier, stamps, clamped[:, 0], unknown, as_of),
            temperature_2=self._read_temperature_2(stamps, known) if Need.TEMPERATURE_2 in self.wanted else nothing,
            supply_voltage=self.supply_voltage.read(known) if Need.SUPPLY_VOLTAGE in self.wanted else nothing,
            acceleration=acceleration,
        )

    def memory(self, stamps: Stamps, unknown: NDArray[np.bool_], as_of: Stamps | None = None) -> Array:
        """Return the states (n, m) of the stage's memories of the temperature; at rest where it is unknown."""
        states = self.temperature.updates.read_memory(stamps, self._latency, self._settings.prediction_horizon, as_of)
        if self._stage.memory is None or not unknown.any():
            return states
        return np.where(unknown[:, None], self._stage.memory.start(self._box.middle[:1]), states)

    def _earlier(
        self, stamps: Stamps, now: Array, unknown: NDArray[np.bool_], as_of: Stamps | None, seconds: float
    ) -> Array:
        temperature = self.temperature.read_earlier(
            stamps, to_nanoseconds(seconds), self._latency, self._settings.prediction_horizon, as_of
        )
        return np.where(unknown, now, np.clip(temperature, self._box.lower[0], self._box.upper[0]))

    def _read_temperature_2(self, stamps: Stamps, known: Stamps) -> Array:
        """Return the second thermometer's trend (n,) in °C, NaN until its first sample is as old as the latency."""
        temperature, _, _ = self.temperature_2.read(stamps, self._latency, self._settings.prediction_horizon, known)
        first = self.temperature_2.first
        return temperature if first is None else np.where(known - self._latency < first, np.nan, temperature)

    def snapshot(self, newest: int | None) -> dict[str, Any]:
        """Return, as plain JSON, all that readings depend on once the accelerometer has come to a stamp, ns."""
        series: dict[str, TemperatureTrack | HeldSeries] = {
            "temperature": self.temperature,
            "temperature_2": self.temperature_2,
            "supply_voltage": self.supply_voltage,
        }
        return {name: one.snapshot(self._still_read(one.updates.last, newest)) for name, one in series.items()}

    def _still_read(self, last: int | None, newest: int | None) -> float:
        """Return the s of history before the sample at ``last`` that a reading may still ask for, both in ns."""
        if last is None or newest is None:
            return self._reach
        # The accelerometer's own stamps may step back by as much as is not yet a jump.
        behind = (last - newest + TIME_JUMP) / NANOSECONDS
        return self._reach - ACCELERATION_LAG + min(max(behind, 0.0), ACCELERATION_LAG)

    def restore(self, snapshot: dict[str, Any]) -> None:
        """Go on from a snapshot; raises ValueError where it does not fit."""
        self.version += 1
        self.temperature.restore(snapshot["temperature"])
        self.temperature_2.restore(snapshot["temperature_2"])
        self.supply_voltage.restore(snapshot["supply_voltage"])
