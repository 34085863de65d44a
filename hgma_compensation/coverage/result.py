"""What a check has to say: of each recording, of each channel, and of each effect on it."""

from dataclasses import dataclass
from enum import Enum
from typing import Any

from hgma_compensation.channels import unit_of


class Level(str, Enum):
    """Whether a recording can show an effect: what it takes is a small, a large, or no size of it."""

    IDENTIFIABLE = "identifiable"
    WEAKLY = "weakly"
    NOT = "not"


@dataclass(frozen=True)
class Parameter:
    """The parameter that a diagnosis would look for. value: that of the size given; low, high: where it shows."""

    name: str
    unit: str
    value: float
    low: float
    high: float


@dataclass(frozen=True)
class EffectCheck:
    """One effect on one channel.

    size: smallest that would be named, RMS about the effect's mean over the recording as errors are given, in the
    channel's unit; None where none would. rival: kind most like it, correlation: with that one, 0 to 1. remedy: what to
    record.
    """

    name: str
    level: Level
    reason: str
    remedy: str = ""
    size: float | None = None
    parameter: Parameter | None = None
    rival: str = ""
    correlation: float = 0.0

    def as_json(self) -> dict[str, Any]:
        """Return the figures."""
        figures = {**vars(self), "level": self.level.value}
        figures["parameter"] = None if self.parameter is None else vars(self.parameter)
        return figures


@dataclass(frozen=True)
class LookAlike:
    """Two effects that the recordings cannot tell apart; correlation of what no drift model carries of them."""

    first: str
    second: str
    correlation: float


@dataclass(frozen=True)
class ChannelCheck:
    """One channel. noise: of a mean of 10 s; drift: range of the fitted drift; small: size that counts as small."""

    name: str
    noise: float
    drift: float
    small: float
    sweeps: int
    effects: tuple[EffectCheck, ...]
    look_alikes: tuple[LookAlike, ...]

    def as_json(self) -> dict[str, Any]:
        """Return the figures."""
        return {
            "unit": unit_of(self.name),
            "noise_of_10_s": self.noise,
            "drift_range": self.drift,
            "small": self.small,
            "sweeps": self.sweeps,
            "effects": {effect.name: effect.as_json() for effect in self.effects},
            "look_alikes": [vars(pair) for pair in self.look_alikes],
        }


@dataclass(frozen=True)
class ChannelFacts:
    """One channel of a recording, in its unit. clipped: samples that stand at a limit of the sensor's range."""

    name: str
    lowest: float
    highest: float
    noise: float
    clipped: int
    vibrating: bool
    shocks: int


@dataclass(frozen=True)
class ThermistorFacts:
    """rate: Hz. noise, lowest, highest: °C. bad: samples that could not be used, by reason. power_ons: starts.

    rates: °C/min of the ramps, each once. soaks: s, lengths. sweeps: coolings and heatings.
    """

    samples: int
    rate: float
    noise: float
    bad: dict[str, int]
    lowest: float
    highest: float
    rates: tuple[float, ...]
    soaks: tuple[float, ...]
    sweeps: int
    power_ons: int


@dataclass(frozen=True)
class RecordingFacts:
    """What is in a recording. duration, longest_gap: s. rate: Hz. averaged: samples taken together to be judged."""

    name: str
    duration: float
    samples: int
    rate: float
    gaps: int
    longest_gap: float
    averaged: int
    channels: tuple[ChannelFacts, ...]
    thermistor: ThermistorFacts
    inputs: tuple[str, ...]

    def as_json(self) -> dict[str, Any]:
        """Return the figures."""
        channels = {one.name: {"unit": unit_of(one.name), **_without_name(one)} for one in self.channels}
        return {**vars(self), "thermistor": vars(self.thermistor), "channels": channels}


@dataclass(frozen=True)
class Check:
    """All recordings and channels. holdout: name of what a diagnosis would not learn from, and was left out."""

    recordings: tuple[RecordingFacts, ...]
    channels: tuple[ChannelCheck, ...]
    holdout: str

    def as_json(self) -> dict[str, Any]:
        """Return the figures in the form that scripts rely on."""
        return {
            "recordings": [facts.as_json() for facts in self.recordings],
            "holdout": self.holdout,
            "channels": {channel.name: channel.as_json() for channel in self.channels},
        }


def _without_name(facts: ChannelFacts) -> dict[str, Any]:
    return {name: value for name, value in vars(facts).items() if name != "name"}
