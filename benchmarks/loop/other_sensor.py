"""Recordings out of a second simulator: another drift, oven, noise, and other forms of every effect."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from benchmarks.loop.experiment import NOMINAL, Experiment
from benchmarks.loop.other_effects import FORMS, WITHOUT_SIZE
from benchmarks.loop.other_unknown import UNKNOWN
from benchmarks.loop.other_world import STEP, World, motion, relaxation, world
from benchmarks.loop.sizes import DRAWS, RATE, WHITE_NOISE, sensible, wanted_scale
from benchmarks.loop.truth import EPOCH, Life, Run, Truth
from hgma_compensation.channels import CHANNELS
from hgma_compensation.recording.csv_table import STANDARD_GRAVITY
from hgma_compensation.recording.recording import Series
from hgma_compensation.stamps import NANOSECONDS

Array = NDArray[np.float64]
Y, Z = (CHANNELS.index(f"linear_acceleration.{axis}") for axis in "yz")
EVERY = round(RATE)
"""Samples of the accelerometer to one of the thermistor."""


def runs(
    names: Sequence[str], plan: Experiment, thermistor_noise: float, random: np.random.Generator
) -> tuple[Run, ...]:
    """Return the recordings of a random sensor that has the named effects; thermistor_noise: °C of one sample."""
    static = static_drift(random)
    around = world(plan, static, random)
    effect = sum((_effect(name, around, plan, random) for name in names), np.zeros_like(around.time))
    per_minute = 60.0 * np.gradient(around.temperature, STEP)
    rate = random.uniform(3.0, 12.0) * STANDARD_GRAVITY * per_minute * (1.0 + random.uniform(-0.2, 0.2) * around.x)
    return _life(around, static(around.temperature) + rate + effect, effect, plan, thermistor_noise, random).cut(
        plan.windows
    )


def static_drift(random: np.random.Generator) -> Callable[[Array], Array]:
    """Return a map from °C to m/s² that spans about 5000 g over -10...60 °C; one in three turns back when hot."""
    turns = random.integers(3) == 0
    bend, wave, place = random.uniform(-0.3, 0.3), random.uniform(0.0, 0.08), random.uniform(-0.4, 0.4)
    if turns:
        bend = -random.uniform(0.6, 0.8)
    size = random.uniform(0.9, 1.1) * (1.0 if random.integers(2) else -1.0)

    def shape(celsius: Array) -> Array:
        x = (celsius - 25.0) / 35.0
        return np.asarray(x + bend * x**2 + 0.2 * np.arctan(2.0 * (x - place)) + wave * np.sin(3.0 * x))

    span = np.ptp(shape(np.linspace(-10.0, 60.0, 200)))
    return lambda celsius: np.asarray(size * 5000.0 * STANDARD_GRAVITY / span * shape(celsius))


def _effect(name: str, around: World, plan: Experiment, random: np.random.Generator) -> Array:
    """Return an effect (n,) with random parameters, of random size."""
    form = UNKNOWN.get(name) or FORMS[name]
    rows = [around.powered & (around.time >= start) & (around.time < end) for start, end in plan.windows]
    heat = [around.temperature[row] for row in rows]
    for _ in range(DRAWS):
        effect = form(around, random)
        parts = [effect[row] for row in rows]
        if name not in WITHOUT_SIZE:
            return effect * wanted_scale(name, parts, heat, random)
        if sensible(parts, heat):
            break
    return effect


def noise(count: int, random: np.random.Generator) -> Array:
    """Return the readout's noise (count,): white, and three relaxations of less than a g in all, no exact 1/f."""
    total = WHITE_NOISE * np.sqrt(RATE) * random.standard_normal(count)
    for time_constant in (3.0, 60.0, 1500.0):
        total += random.uniform(0.2, 0.6) * STANDARD_GRAVITY * relaxation(count, time_constant, random)
    return total


def _life(
    around: World, drift: Array, effect: Array, plan: Experiment, thermistor_noise: float, random: np.random.Generator
) -> Life:
    count, on = len(around.time), around.powered
    acceleration = STANDARD_GRAVITY + around.z + motion(around, random)
    values = np.zeros((count, len(CHANNELS)))
    values[:, Z] = acceleration + drift + noise(count, random)
    present = ["linear_acceleration.z"]
    if "lateral" in plan.parts:
        values[:, Y] = around.y + random.uniform(-300.0, 300.0) * STANDARD_GRAVITY * around.x + noise(count, random)
        present.insert(0, "linear_acceleration.y")
    stamps = EPOCH + np.rint(around.time * NANOSECONDS).astype(np.int64)

    def log(true: Array, deviation: float) -> Series:
        rows = np.flatnonzero(on[::EVERY]) * EVERY
        return Series(stamps[rows], true[rows] + deviation * random.standard_normal(len(rows)))

    return Life(
        stamps=stamps[on],
        values=values[on],
        present=tuple(present),
        temperature=log(around.temperature, thermistor_noise),
        temperature_2=log(around.package, 0.03) if "heating" in plan.parts else Series.empty(),
        supply_voltage=log(NOMINAL + around.voltage, 0.002) if "supply" in plan.parts else Series.empty(),
        truth=Truth(*(part[on] for part in (around.temperature, drift, effect, acceleration))),
    )
