"""What a scenario describes, in SI units and °C. Times are s from the beginning of the oven's programme."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from hgma_compensation.simulation.effect import Effect
from hgma_compensation.simulation.motion_description import Motion


@dataclass(frozen=True)
class Step:
    """Ramp of the set-point to a temperature (°C) at a rate (°C/min), then a soak (min)."""

    to: float
    rate: float
    soak: float


@dataclass(frozen=True)
class Ripple:
    """Swing of the chamber about its set-point as the compressor switches: amplitude in °C, period in s."""

    amplitude: float
    period: float


@dataclass(frozen=True)
class Oven:
    """start: °C. chamber_time_constant: of the chamber's air; time_constant: of the sensor in it, s."""

    start: float
    time_constant: float
    program: tuple[Step, ...]
    chamber_time_constant: float = 0.0
    ripple: Ripple | None = None

    @property
    def duration(self) -> float:
        """Length of the programme, s."""
        before, total = self.start, 0.0
        for step in self.program:
            total += 60.0 * (abs(step.to - before) / step.rate + step.soak)
            before = step.to
        return total


@dataclass(frozen=True)
class Powered:
    """The sensor runs from start until before end, s."""

    start: float
    end: float = np.inf


@dataclass(frozen=True)
class Heating:
    """Heat from outside the oven at the second thermometer: rise in °C it tends to from start until end, s."""

    start: float
    end: float
    rise: float


@dataclass(frozen=True)
class Thermometer:
    """rate: Hz. noise: °C of one sample. lag: s. resolution: °C, 0 for none. heating: second one only."""

    rate: float
    noise: float
    lag: float = 0.0
    resolution: float = 0.0
    heating: tuple[Heating, ...] = ()


@dataclass(frozen=True)
class VoltageStep:
    """A change (V) of the supply that begins at a time (s) and stays."""

    time: float
    change: float


@dataclass(frozen=True)
class Supply:
    """rate: Hz. nominal: V. noise: V of one logged sample. wander: V, over wander_period: s."""

    rate: float
    nominal: float
    noise: float = 0.0
    wander: float = 0.0
    wander_period: float = 7200.0
    steps: tuple[VoltageStep, ...] = ()


@dataclass(frozen=True)
class Axis:
    """One axis, as far as it is no effect.

    true_value: specific force of the still sensor, m/s². drift_span: m/s² over -10...60 °C. rate_drift: m/s²
    per °C/min. white_noise: m/s²/√Hz. bias_instability: m/s². full_scale: m/s². lsb: m/s², 0 for none.
    """

    true_value: float = 0.0
    drift_span: float = 0.0
    rate_drift: float = 0.0
    white_noise: float = 0.0
    bias_instability: float = 0.0
    full_scale: float = np.inf
    lsb: float = 0.0


@dataclass(frozen=True)
class FirstMode:
    """Resonance of the proof mass on its beams: frequency in Hz, quality factor."""

    frequency: float
    quality: float


@dataclass(frozen=True)
class AppliedEffect:
    """An effect on some axes; declared: named in the ground truth."""

    name: str
    effect: Effect
    axes: tuple[str, ...]
    declared: bool = False


@dataclass(frozen=True)
class Scenario:
    """An oven test. Rates in Hz; thermistor_noise of one sample, thermistor_resolution: °C; thermistor_lag: s.

    block: accelerometer samples in one message.
    """

    name: str
    seed: int
    sensor_id: str
    oven: Oven
    thermistor_rate: float
    thermistor_noise: float
    accelerometer_rate: float
    axes: Mapping[str, Axis]
    thermistor_lag: float = 0.0
    thermistor_resolution: float = 0.0
    second_thermometer: Thermometer | None = None
    supply: Supply | None = None
    first_mode: FirstMode | None = None
    powered: tuple[Powered, ...] = (Powered(0.0),)
    motion: Motion = field(default_factory=Motion)
    effects: tuple[AppliedEffect, ...] = ()
    ground_truth: bool = False
    block: int = 1

    @property
    def thermistor(self) -> Thermometer:
        """The thermometer on the sensor."""
        return Thermometer(self.thermistor_rate, self.thermistor_noise, self.thermistor_lag, self.thermistor_resolution)
