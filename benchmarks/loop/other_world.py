"""Oven, supply and motion of a second simulator, which shares nothing with the project's own but the experiment."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import cont2discrete, lfilter

from benchmarks.loop.experiment import NOMINAL, Experiment
from benchmarks.loop.sizes import RATE
from hgma_compensation.recording.csv_table import STANDARD_GRAVITY

Array = NDArray[np.float64]
STEP = 1.0 / RATE

SHOCK = np.array([0.55, 1.0, 0.3, -0.1])
"""Samples of a shock over its peak."""


@dataclass(frozen=True)
class World:
    """All that an effect can answer to, every 0.2 s from the start of the first recording on, each (n,).

    time: s. temperature, package: °C. voltage: V from nominal. powered. y, z: m/s², what the sensor is held at, z
    less its weight. power: mean square of the vibration, (m/s²)². shocks: (time in s, peak in m/s²). static: drift
    (n,) in m/s² at temperatures (n,).
    """

    time: Array
    temperature: Array
    package: Array
    voltage: Array
    powered: NDArray[np.bool_]
    y: Array
    z: Array
    power: Array
    shocks: tuple[tuple[float, float], ...]
    static: Callable[[Array], Array]

    @property
    def x(self) -> Array:
        """Temperature from 25 °C over 35 °C, (n,)."""
        return np.asarray((self.temperature - 25.0) / 35.0)


def world(plan: Experiment, static: Callable[[Array], Array], random: np.random.Generator) -> World:
    """Return the surroundings of a sensor with that static drift."""
    time = np.asarray(np.arange(round(plan.duration * RATE)) * STEP, dtype=np.float64)
    air = oven_air(plan, time, random)
    heat, power = np.zeros(len(time)), np.zeros(len(time))
    for pulse in plan.heating:
        heat += pulse.rise * ((time >= pulse.start) & (time < pulse.end))
    for burst in plan.vibrations:
        power += burst.rms**2 * ((time >= burst.start) & (time < burst.end))
    return World(
        time=time,
        temperature=follow(air, random.uniform(20.0, 60.0)),
        package=follow(air + heat, random.uniform(15.0, 30.0)) + follow(0.1 * heat, 200.0),
        voltage=voltage(plan, time, random) if "supply" in plan.parts else np.zeros_like(time),
        powered=np.any([(time >= p.start) & (time < p.end) for p in plan.powered], axis=0),
        y=held(plan, time, 1, 0.0),
        z=held(plan, time, 2, STANDARD_GRAVITY),
        power=power,
        shocks=tuple((shock.time, shock.peak) for shock in plan.shocks),
        static=static,
    )


def oven_air(plan: Experiment, time: Array, random: np.random.Generator) -> Array:
    """Return the temperature (n,) of an oven that overshoots (second order) and whose compressor ripples."""
    frequency, damping = 1.0 / random.uniform(15.0, 40.0), random.uniform(0.55, 0.8)
    corners, before, now = [(0.0, 25.0)], 25.0, 0.0
    for step in plan.steps:
        now += 60.0 * abs(step.to - before) / step.rate
        corners += [(now, step.to), (now + 60.0 * step.soak, step.to)]
        now, before = now + 60.0 * step.soak, step.to
    wanted = np.interp(time, *np.array(corners).T)
    system = ([frequency**2], [1.0, 2.0 * damping * frequency, frequency**2])
    numerator, denominator, _ = cont2discrete(system, STEP, method="bilinear")
    reached = wanted[0] + lfilter(numerator.ravel(), denominator, wanted - wanted[0])
    saw = 2.0 * np.abs(2.0 * ((time / random.uniform(120.0, 300.0)) % 1.0) - 1.0) - 1.0
    return np.asarray(reached + random.uniform(0.0, 0.2) * saw)


def voltage(plan: Experiment, time: Array, random: np.random.Generator) -> Array:
    """Return the deviation (n,) of the supply in V: its steps, rounded off, and a slow random wander."""
    steps = np.zeros(len(time))
    for step in plan.voltage_steps:
        steps += step.change * (time >= step.time)
    wander = follow(relaxation(len(time), 1200.0, random), 300.0)
    return follow(steps, 3.0) + random.uniform(0.0, 0.005) * NOMINAL * wander


def held(plan: Experiment, time: Array, column: int, still: float) -> Array:
    """Return the acceleration (n,) of an axis less its still value, moved smoothly from level to level."""
    total, before = np.zeros_like(time), 0.0
    for orientation in plan.orientations:
        level = orientation.specific_force[column] - still
        phase = np.clip((time - orientation.time) / orientation.turn, 0.0, 1.0)
        total += (level - before) * phase**2 * (3.0 - 2.0 * phase)
        before = level
    return total


def motion(around: World, random: np.random.Generator) -> Array:
    """Return what moves the sensor (n,) along z beside its levels: vibration close to half the sample rate, shocks."""
    alternating = np.where(np.arange(len(around.time)) % 2, 1.0, -1.0)
    wave = lfilter([np.sqrt(1.0 - 0.8**2)], [1.0, -0.8], random.standard_normal(len(around.time)))
    total = np.sqrt(around.power) * alternating * wave
    for time, peak in around.shocks:
        first = int(np.searchsorted(around.time, time))
        total[first : first + len(SHOCK)] += peak * SHOCK[: len(total) - first]
    return np.asarray(total)


def follow(values: Array, time_constant: float) -> Array:
    """Return values (n,) through one pole, settled at the first."""
    keep = float(np.exp(-STEP / time_constant))
    return np.asarray(lfilter([1.0 - keep], [1.0, -keep], values, zi=[keep * values[0]])[0])


def relaxation(count: int, time_constant: float, random: np.random.Generator) -> Array:
    """Return noise (count,) of unit variance that forgets itself in a time (s), stationary from the first sample on."""
    keep = float(np.exp(-STEP / time_constant))
    steps = random.standard_normal(count)
    steps[1:] *= np.sqrt(1.0 - keep**2)
    return np.asarray(lfilter([1.0], [1.0, -keep], steps))
