"""Estimates of a temperature in the order of their stamps, and what a memory made of them, readable at any stamp.

A reading at stamp t uses the newest update whose stamp is at most t - latency and predicts from it. It depends on
stamps alone, never on the order in which messages arrived, so a batch and a stream give the same bits as long as a
sample arrives within the latency. Only the first update after a power-on is used from its own stamp on: until there
is a second, it is all that is known.
"""

from collections.abc import Iterable
from math import inf
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.effects.memory import POWER_OFF as POWER_OFF_SECONDS
from hgma_compensation.effects.memory import TemperatureMemory
from hgma_compensation.stamps import NANOSECONDS, Stamps, seconds_between, to_nanoseconds
from hgma_compensation.temperature.limited_memory import LimitedMemory
from hgma_compensation.temperature.unusable import UnusableStamps
from hgma_compensation.temperature.update_table import UpdateTable
from hgma_compensation.time_jumps import RECALL, TIME_JUMP, StepBack, step_back

Array = NDArray[np.float64]

POWER_OFF = to_nanoseconds(POWER_OFF_SECONDS)
"""A sensor whose thermometer was silent for longer had been switched off."""


class Updates:
    """Temperature, rate, state of a memory and stamp of the power-on at each update."""

    def __init__(
        self,
        memory: TemperatureMemory | None = None,
        *,
        limits: tuple[float, float] = (-inf, inf),
        keep: int | None = None,
    ) -> None:
        """Start empty.

        limits: °C between which the memory is told the temperature. keep: ns of history that a stream must hold on
        to, None for all of it.
        """
        self._memory = LimitedMemory(memory, limits)
        self._table = UpdateTable(2 + self._memory.size, keep)
        self.unusable = UnusableStamps(bounded=keep is not None)
        self.reset()

    def reset(self) -> None:
        """Forget all updates."""
        self._table.clear()
        self.unusable.clear()
        self._gap: tuple[int, int] | None = None
        self.first: int | None = None
        self.first_temperature = 0.0
        self._equilibrium = np.full(self._memory.size, np.nan)
        self._powered_before: int | None = None

    def __len__(self) -> int:
        """Return the number of updates that are held."""
        return len(self._table)

    @property
    def last(self) -> int | None:
        """Stamp of the newest update, ns."""
        return int(self._table.stamps[-1]) if len(self) else None

    @property
    def stamps(self) -> Stamps:
        """Stamps (n,) of the updates that are held, ns."""
        return self._table.stamps

    @property
    def temperatures(self) -> Array:
        """Temperatures (n,) of the updates that are held, °C."""
        return self._table.values[:, 0]

    @property
    def power_on(self) -> int | None:
        """Stamp of the newest power-on, ns."""
        return int(self._table.power_on[-1]) if len(self) else None

    def assume_power_on(self, stamp: int) -> None:
        """Take it, before the first update, that the sensor was switched on at a stamp (ns) before it."""
        self._powered_before = stamp

    def is_power_on(self, stamp: int) -> bool:
        """Return whether an update at a stamp (ns) would be the first after the sensor had been off."""
        return self.last is not None and stamp - self.last > POWER_OFF

    def append(self, stamp: int, temperature: float, rate: float) -> None:
        """Take an update, later than all before: stamp in ns, °C, °C/s."""
        last = self.last
        if last is None:
            self.first, self.first_temperature = stamp, temperature
            self._equilibrium = self._memory.start(temperature)
            power_on = stamp if self._powered_before is None else self._powered_before
            state = self._equilibrium
        else:
            power_on = stamp if self.is_power_on(stamp) else int(self._table.power_on[-1])
            if stamp - last > TIME_JUMP:
                self._gap = (last, stamp)
            seconds, before = np.array([(stamp - last) * 1e-9]), self._table.values[-1:, 0]
            state = self._memory.advance(self._table.values[-1:, 2:], seconds, before, np.array([temperature]))[0]
        if self._gap is not None and stamp - self._gap[1] > RECALL:
            self._gap = None
        needed_from = stamp if self._gap is None else self._gap[0]
        self._table.append(stamp, power_on, np.array([temperature, rate, *state]), needed_from)

    def step_back(self, stamp: int) -> StepBack | None:
        """Return what a stamp (ns) before the newest update means; None where it shows that one to have been wrong.

        That is a stamp which goes on after the last update before a pause, soon after that pause.
        """
        assert self.last is not None
        assert self.first is not None
        meaning = step_back(stamp, self.last, self.first)
        continues = self._gap is not None and stamp > self._gap[0]
        return None if continues and meaning is not StepBack.LATE else meaning

    def recall(self) -> None:
        """Forget the updates since the last pause."""
        assert self._gap is not None
        before = self._gap[0]
        self._table.truncate(int(self._table.stamps.searchsorted(before, side="right")))
        self.unusable.forget_after(before)
        self._gap = None

    def set_back(self, stamp: int) -> None:
        """Move all updates to a clock that was set back, so that ``stamp`` (ns) comes an interval after the newest."""
        assert self.last is not None
        assert self.first is not None
        stamps = self._table.stamps
        interval = int(stamps[-1] - stamps[-2]) if len(stamps) > 1 else NANOSECONDS
        back = self.last + min(interval, POWER_OFF) - stamp
        self._table.shift(-back)
        self.unusable.shift(-back)
        self.first, self._gap = self.first - back, None

    def extend(self, stamps: Iterable[int], temperature: Iterable[float], rate: Iterable[float]) -> None:
        """Take many updates, as ``append`` would one after the other."""
        for stamp, celsius, slope in zip(stamps, temperature, rate, strict=True):
            self.append(int(stamp), float(celsius), float(slope))

    def read(
        self, stamps: Stamps, latency: int, horizon: float, as_of: Stamps | None = None
    ) -> tuple[Array, Array, Array]:
        """Return T (°C), Ṫ (°C/s) and the age (s) of the update they come from, each of shape (n,).

        stamps: ns. latency: ns that an update must be older than a stamp to be used; the first one after a power-on is
        used from its own stamp on. horizon: s over which Ṫ is extrapolated; an older update is held. Before the first
        update, T is that of the first one (steady before the start), Ṫ is 0 and the age infinite. as_of: (n,) ns, the
        stamps that decide which update is used, where those are not ``stamps``: what was predicted then.
        """
        if not len(self):
            return np.full(len(stamps), np.nan), np.zeros(len(stamps)), np.full(len(stamps), np.inf)
        known = stamps if as_of is None else as_of
        table, index = self._table, self._table.used(known, latency)
        before = known < table.stamps[0]
        age = seconds_between(stamps, table.stamps[index])
        temperature, rate = table.values[index, 0], table.values[index, 1]
        predicted = temperature + rate * np.minimum(age, horizon)
        return (
            np.where(before, self.first_temperature, predicted),
            np.where(before, 0.0, rate),
            np.where(before, np.inf, age),
        )

    def read_earlier(
        self, stamps: Stamps, back: int, latency: int, horizon: float, as_of: Stamps | None = None
    ) -> Array:
        """Return T (n,), °C, ``back`` ns before stamps; steady before the power-on that each stamp is after.

        Other arguments as for ``read``.
        """
        if not len(self):
            return self.read(stamps, latency, horizon)[0]
        power_on = self._table.power_on[self._table.used(stamps if as_of is None else as_of, latency)]
        at = np.maximum(stamps - back, power_on)
        return self.read(at, latency, horizon, None if as_of is None else np.maximum(as_of - back, power_on))[0]

    def read_memory(self, stamps: Stamps, latency: int, horizon: float, as_of: Stamps | None = None) -> Array:
        """Return the memory's states (n, m): those of the updates used, moved on to the predicted temperature.

        Arguments as for ``read``. Before the first update: in equilibrium at its temperature; NaN where there is none.
        """
        if not len(self):
            return np.full((len(stamps), self._memory.size), np.nan)
        known = stamps if as_of is None else as_of
        table, index = self._table, self._table.used(known, latency)
        before = known < table.stamps[0]
        # A time that runs backwards would make some memories overflow before their states are thrown away.
        seconds = np.where(before, 0.0, np.minimum(seconds_between(stamps, table.stamps[index]), horizon))
        predicted = table.values[index, 0] + table.values[index, 1] * seconds
        moved = self._memory.advance(table.values[index, 2:], seconds, table.values[index, 0], predicted)
        return np.where(before[:, None], self._equilibrium, moved)

    def since_power_on(self, stamps: Stamps, latency: int, as_of: Stamps | None = None) -> Array:
        """Return the time since the power-on (n,) in s, 0 before the first update; as_of: as for ``read``."""
        if not len(self):
            return np.zeros(len(stamps))
        known = stamps if as_of is None else as_of
        since = seconds_between(stamps, self._table.power_on[self._table.used(known, latency)])
        return np.where(known < self._table.stamps[0], 0.0, since)

    def last_is_unusable(self, stamps: Stamps, latency: int) -> NDArray[np.bool_]:
        """Return (n,) whether an unusable sample as old as the latency (ns) is newer than the update in use."""
        if not len(self.unusable):
            return np.zeros(len(stamps), dtype=np.bool_)
        if not len(self):
            return self.unusable.at_or_after(np.zeros(len(stamps), dtype=np.int64), stamps - latency)
        return self.unusable.at_or_after(self._table.stamps[self._table.used(stamps, latency)], stamps - latency)

    def changes(self, low: int, high: int, latency: int) -> Stamps:
        """Return the stamps in low < s < high (ns) from which on a reading may use another update, in no order.

        Also those from which on it knows of an unusable sample.
        """
        found = [
            self._table.adopted(low, high, latency),
            self.unusable.between(low - latency, high - latency) + latency,
        ]
        if self.first is not None and low < self.first < high:
            found.append(np.array([self.first], dtype=np.int64))
        return np.concatenate(found)

    def snapshot(self, reach: int) -> dict[str, Any]:
        """Return, as plain JSON, all that readings within ``reach`` ns of the newest update depend on."""
        return {
            "first": self.first,
            "first_temperature": self.first_temperature,
            "equilibrium": self._equilibrium.tolist() if len(self) else [],
            **self._table.snapshot(0 if self.last is None else self.last - reach),
        }

    def restore(self, snapshot: dict[str, Any]) -> None:
        """Go on from a snapshot of updates with the same memory; raises ValueError where it is none."""
        self.reset()
        self._table.restore(snapshot)
        if len(self):
            self.first, self.first_temperature = int(snapshot["first"]), float(snapshot["first_temperature"])
            self._equilibrium = np.array(snapshot["equilibrium"], dtype=np.float64).reshape(self._memory.size)
