"""State machines behind effects that remember: of the temperature, and of the acceleration."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.stamps import Stamps

Array = NDArray[np.float64]

POWER_OFF = 60.0
"""s without a thermistor sample after which the sensor counts as having been off."""


class TemperatureMemory(Protocol):
    """State (m,) that each thermistor sample moves on."""

    @property
    def size(self) -> int:
        """Return m."""
        ...

    def start(self, temperature: Array) -> Array:
        """Return the state (m,) of a sensor that has been at a temperature (°C, shape (1,)) for ever."""
        ...

    def advance(self, state: Array, seconds: Array, before: Array, temperature: Array) -> Array:
        """Return states (n, m) some seconds (n, 1) after ``state`` (n, m).

        The temperature went evenly from ``before`` to ``temperature``, (n, 1) each, in °C.
        """
        ...


@dataclass(frozen=True)
class LowPass:
    """One-pole low-passes of the temperature, time_constants τ in s.

    The temperature goes evenly from T₀ to T₁ within a step dt (first-order hold; Franklin et al. 1998, section 6.2.3):
    s ← T₁ + e·(s − T₀) − f·(T₁ − T₀), e = e^(−x), f = (1 − e)/x, x = dt/τ. So a slow thermistor, or a pause in which
    the sensor was off, makes no lag of its own.
    """

    time_constants: tuple[float, ...]

    @cached_property
    def _times(self) -> Array:
        return np.array(self.time_constants)

    @property
    def size(self) -> int:
        """Return the number of poles."""
        return len(self.time_constants)

    def start(self, temperature: Array) -> Array:
        """Return the states in equilibrium."""
        return np.broadcast_to(temperature, (self.size,)).copy()

    def advance(self, state: Array, seconds: Array, before: Array, temperature: Array) -> Array:
        """Return the states after a ramp of the temperature."""
        x = seconds / self._times
        kept = np.exp(-x)
        # (1 − e^(−x))/x, which is 1 where no time goes by.
        mean = np.where(x > 0.0, -np.expm1(-x) / np.where(x > 0.0, x, 1.0), 1.0)
        # Written so that equilibrium stays equilibrium to the last bit.
        return np.asarray(temperature + kept * (state - before) - mean * (temperature - before))


@dataclass(frozen=True)
class Play:
    """Play operators: w = min(max(w, T − r), T + r); thresholds r in °C (Visintin 1994, section III.2).

    before, offset: the plays once stood ``offset`` thresholds above a temperature ``before`` (°C), from where the
    material went straight to its first one here; None for a material without a past.
    """

    thresholds: tuple[float, ...]
    before: float | None = None
    offset: float = 0.0

    @cached_property
    def _reach(self) -> Array:
        return np.array(self.thresholds)

    @property
    def size(self) -> int:
        """Return the number of plays."""
        return len(self.thresholds)

    def start(self, temperature: Array) -> Array:
        """Return the states at the first temperature."""
        reach = self._reach
        if self.before is None:
            return np.broadcast_to(temperature, (self.size,)).copy()
        return np.asarray(np.clip(self.before + self.offset * reach, temperature - reach, temperature + reach))

    def advance(self, state: Array, seconds: Array, before: Array, temperature: Array) -> Array:
        """Return the states after a change of the temperature; time does nothing to them."""
        reach = self._reach
        return np.asarray(np.minimum(np.maximum(state, temperature - reach), temperature + reach))


@dataclass(frozen=True)
class Coldness:
    """How far the sensor's own heat is from its end: 1 at power-on after a long rest, 0 when warm.

    Decays with each time constant (s) while samples come, and grows back while they do not: a pause of more than
    POWER_OFF seconds is taken for a sensor without power.
    """

    time_constants: tuple[float, ...]

    @property
    def size(self) -> int:
        """Return the number of time constants."""
        return len(self.time_constants)

    def start(self, temperature: Array) -> Array:
        """Return the state at the first power-on."""
        return np.ones(self.size)

    def advance(self, state: Array, seconds: Array, before: Array, temperature: Array) -> Array:
        """Return the states after a time with power, or without where it is a long one."""
        kept = np.exp(seconds / -np.array(self.time_constants))
        # A minute between two stamps comes out a bit longer, as does every product with the rounded 1e-9.
        off = seconds > POWER_OFF * (1.0 + 1e-12)
        return np.where(off, 1.0 - (1.0 - state) * kept, state * kept)


class AccelerationMemory(Protocol):
    """State (m,) that each sample of the accelerometer moves on."""

    @property
    def size(self) -> int:
        """Return m."""
        ...

    def start(self) -> Array:
        """Return the state (m,) before any sample."""
        ...

    def run(self, state: Array, stamps: Stamps, acceleration: Array) -> Array:
        """Return the states (n, m) after each of n samples: stamps (n,) in ns, acceleration (n,)."""
        ...

    def raised(self, state: Array, by: float) -> Array:
        """Return the state (m,) of a sensor that showed ``by`` more in all samples so far."""
        ...


Part = TypeVar("Part", bound=TemperatureMemory)


class Bank:
    """Several memories of the temperature side by side; poles and plays of equal kind move in one operation."""

    KINDS: ClassVar[dict[type, str]] = {LowPass: "time_constants", Play: "thresholds", Coldness: "time_constants"}

    def __init__(self, memories: Sequence[TemperatureMemory]) -> None:
        """Take the memories; ``columns[i]`` are the places (m_i,) of memory i in the state."""
        order = sorted(range(len(memories)), key=lambda i: self._kind(memories[i]))
        self.columns: list[NDArray[np.int64]] = [np.empty(0, dtype=np.int64)] * len(memories)
        self._parts: list[tuple[slice, TemperatureMemory]] = []
        self.size = 0
        for index in order:
            memory = memories[index]
            self.columns[index] = np.arange(self.size, self.size + memory.size)
            self._append(memory)
            self.size += memory.size

    def _kind(self, memory: TemperatureMemory) -> int:
        return next((n for n, kind in enumerate(self.KINDS) if type(memory) is kind), len(self.KINDS))

    def _append(self, memory: TemperatureMemory) -> None:
        if self._parts:
            place, last = self._parts[-1]
            field = self.KINDS.get(type(memory))
            if field is not None and type(last) is type(memory):
                joined: Any = replace(memory, **{field: getattr(last, field) + getattr(memory, field)})  # type: ignore[type-var]
                if replace(joined, **{field: getattr(last, field)}) == last:  # alike in all but that field
                    self._parts[-1] = (slice(place.start, place.stop + memory.size), joined)
                    return
        self._parts.append((slice(self.size, self.size + memory.size), memory))

    def start(self, temperature: Array) -> Array:
        """Return the state (m,) in equilibrium at a temperature (1,)."""
        state = np.empty(self.size)
        for place, memory in self._parts:
            state[place] = memory.start(temperature)
        return state

    def advance(self, state: Array, seconds: Array, before: Array, temperature: Array) -> Array:
        """Return states (n, m) after states (n, m), seconds (n, 1) later at temperature (n, 1)."""
        if len(self._parts) == 1:
            return self._parts[0][1].advance(state, seconds, before, temperature)
        moved = np.empty_like(state)
        for place, memory in self._parts:
            moved[:, place] = memory.advance(state[:, place], seconds, before, temperature)
        return moved
