"""What a generator hands over: recordings of one sensor, and what lies behind them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.recording.recording import Recording, Series
from hgma_compensation.simulation.oven_test import EPOCH
from hgma_compensation.stamps import NANOSECONDS, Stamps

Array = NDArray[np.float64]

NAMES = ("day 1", "day 2", "day 3", "held out")


@dataclass(frozen=True)
class Truth:
    """At the stamps of one recording, channel z, each (n,): °C and m/s².

    drift: all of it without noise. effect: the part of it that nobody is told. acceleration: what the sensor
    undergoes, its weight included.
    """

    temperature: Array
    drift: Array
    effect: Array
    acceleration: Array


@dataclass(frozen=True)
class Run:
    """One recording and its truth."""

    recording: Recording
    truth: Truth


@dataclass(frozen=True)
class Life:
    """The whole time from the first recording to the end of the last, pauses without samples.

    stamps: (n,) ns; values: (n, 6).
    """

    stamps: Stamps
    values: Array
    present: tuple[str, ...]
    temperature: Series
    temperature_2: Series
    supply_voltage: Series
    truth: Truth

    def cut(self, windows: tuple[tuple[float, float], ...]) -> tuple[Run, ...]:
        """Return the recordings in the windows (start, end), s from the simulator's EPOCH."""
        return tuple(self._run(name, *window) for name, window in zip(NAMES, windows, strict=True))

    def _run(self, name: str, start: float, end: float) -> Run:
        first, last = (EPOCH + round(time * NANOSECONDS) for time in (start, end))
        rows = (self.stamps >= first) & (self.stamps < last)
        recording = Recording(
            name=name,
            stamps=self.stamps[rows],
            values=self.values[rows],
            present=self.present,
            temperature=self.temperature.between(first, last),
            temperature_2=self.temperature_2.between(first, last),
            supply_voltage=self.supply_voltage.between(first, last),
            frame="loop_link",
        )
        truth = self.truth
        parts = (truth.temperature, truth.drift, truth.effect, truth.acceleration)
        return Run(recording, Truth(*(part[rows] for part in parts)))
