"""What every effect is: its parameters, its memory, its columns."""

from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass, fields
from enum import Enum
from math import isfinite
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.channels import CHANNELS
from hgma_compensation.effects.conditions import Conditions
from hgma_compensation.effects.memory import AccelerationMemory, TemperatureMemory
from hgma_compensation.errors import RefusedError

Array = NDArray[np.float64]

SETTLED = 3.0
"""Time constants after which a memory has forgotten all but a twentieth of what it began with."""


class Need(str, Enum):
    """An input that not every recording has."""

    TEMPERATURE_2 = "temperature_2"
    SUPPLY_VOLTAGE = "supply_voltage"
    OTHER_AXIS = "another axis"


@dataclass(frozen=True)
class Span:
    """Unit and limits of a parameter. searched: a diagnosis looks for its value; else it is given."""

    unit: str
    lower: float
    upper: float
    searched: bool = True


@dataclass(frozen=True)
class Survey:
    """What recordings span, for effects to propose parameters: °C, s, ns of the first sample.

    channel: the one in question. others: channels beside it that have samples. ramp: °C/s, a large rate.
    interval: s, what the data resolve. noise: deviation of one sample. origin: stamp of the first sample, ns.
    voltage: V, typical. lifetime: s from the first sample to the last, pauses included; duration is that of one
    recording. vibration, inputs, shocks: whether the channel's noise, and its level by real acceleration, ever
    changed, and whether single samples ever stood out.
    """

    channel: str
    others: tuple[str, ...]
    lowest: float
    highest: float
    duration: float
    interval: float
    ramp: float
    noise: float
    origin: int
    voltage: float = 0.0
    lifetime: float = 0.0
    vibration: bool = True
    inputs: bool = True
    shocks: bool = True


class Effect(ABC):
    """One effect on one channel, without its gains: drift = Σ gainsᵢ·columnᵢ. Immutable; a frozen dataclass.

    Class variables describe the kind: name, as in calibration files; title, for people; spans of the parameters, one
    for each numeric field; needs; identified_by: what must vary in a recording; confused_with: names of effects that
    look alike where it does not; slow: whether the columns answer to the thermometers, the supply voltage and time
    alone, and within a tenth of a second bend no more than they do, so that they need not be evaluated for each sample;
    gain_unit: unit of the gains over the channel's; per_sample: whether the columns
    bend with the acceleration, so that they must be averaged and not be taken at the average; folds_in_time: whether
    time rather than temperature drives it; family: name under which a diagnosis reports it, "" for its own;
    input_driven: whether it answers to real acceleration along its own axis.
    """

    name: ClassVar[str]
    title: ClassVar[str]
    spans: ClassVar[dict[str, Span]] = {}
    needs: ClassVar[tuple[Need, ...]] = ()
    identified_by: ClassVar[str] = ""
    confused_with: ClassVar[tuple[str, ...]] = ()
    slow: ClassVar[bool] = False
    gain_unit: ClassVar[str] = ""
    family: ClassVar[str] = ""
    per_sample: ClassVar[bool] = False
    folds_in_time: ClassVar[bool] = False
    input_driven: ClassVar[bool] = False

    @property
    def history(self) -> float:
        """Seconds of the thermistor's past that ``earlier`` is asked for."""
        return 0.0

    @property
    def settling(self) -> float:
        """Seconds after which a memory that began without a past no longer shows it."""
        return self.history

    @property
    def settling_span(self) -> float:
        """Span in °C that the temperature must cover until then, where travel and not time makes it forget."""
        return 0.0

    def memory(self) -> TemperatureMemory | None:
        """Return the memory of the temperature, None where there is none."""
        return None

    def acceleration_memory(self) -> AccelerationMemory | None:
        """Return the memory of the channel's own acceleration, None where there is none."""
        return None

    @property
    @abstractmethod
    def count(self) -> int:
        """Number of columns k."""

    @abstractmethod
    def columns(self, at: Conditions, state: Array) -> Array:
        """Return the columns (n, k); state: (n, m) of the memory. Each row depends on its own sample only."""

    def richer(self, survey: Survey) -> Iterator["Effect"]:
        """Yield forms of the same effect with more columns, to be tried once it is found; none by default."""
        yield from ()

    def inside(self, survey: Survey) -> bool:
        """Return whether data such as those surveyed could determine the effect with these parameters."""
        return True

    def search_step(self, survey: Survey) -> float:
        """Return how far from a candidate its parameter may lie: in ln where it is positive, else in its unit."""
        return 0.4 if all(span.lower > 0.0 for span in self.spans.values() if span.searched) else 1.0

    @classmethod
    @abstractmethod
    def candidates(cls, survey: Survey) -> Iterator["Effect"]:
        """Yield the effect with parameters over a grid that leaves no gap."""

    def parameters(self) -> dict[str, Any]:
        """Return the parameters by name, as they stand in a calibration file."""
        return {field.name: getattr(self, field.name) for field in fields(self)}  # type: ignore[arg-type]

    def check(self) -> None:
        """Raise RefusedError, naming the parameter, where one lies outside its span."""
        for name, span in self.spans.items():
            value = getattr(self, name)
            if not (isfinite(value) and span.lower <= value <= span.upper):
                raise RefusedError(
                    f"{name} is {value!r}, must be {span.lower:g} to {span.upper:g} {span.unit}".rstrip()
                )


def normalised(temperature: Array) -> Array:
    """Return x = (T − 25 °C) / 35 °C, -1...1 over the paper's oven test."""
    return np.asarray((temperature - 25.0) / 35.0)


def no_memory(count: int) -> Array:
    """Return the state of a memory that there is none of."""
    return np.empty((count, 0))


def column_of(channel: str) -> int:
    """Return the column of a channel in ``Conditions.acceleration``."""
    return CHANNELS.index(channel)
