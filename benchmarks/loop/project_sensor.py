"""Recordings out of the project's own simulator, without a bag in between."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from benchmarks.loop import project_effects
from benchmarks.loop.experiment import NOMINAL, Experiment
from benchmarks.loop.sizes import DRAWS, RATE, WHITE_NOISE, sensible, wanted_scale
from benchmarks.loop.truth import Life, Run, Truth
from hgma_compensation.recording.csv_table import STANDARD_GRAVITY
from hgma_compensation.simulation.description import AppliedEffect, Axis, Oven, Ripple, Scenario, Supply, Thermometer
from hgma_compensation.simulation.effect import Effect
from hgma_compensation.simulation.motion_description import Motion
from hgma_compensation.simulation.noise import streams_of
from hgma_compensation.simulation.oven import power_state, temperatures
from hgma_compensation.simulation.oven_test import simulate_with_truth
from hgma_compensation.simulation.sensor import Sensor

Array = NDArray[np.float64]
Z = 2

UNKNOWN = ("random_walk", "telegraph_noise", "humidity")
"""Structure of this simulator that no catalogue names."""


def runs(
    names: Sequence[str], plan: Experiment, thermistor_noise: float, random: np.random.Generator
) -> tuple[Run, ...]:
    """Return the recordings of a random sensor that has the named effects; thermistor_noise: °C of one sample."""
    scenario = _scenario(plan, thermistor_noise, random)
    scenario = replace(scenario, effects=tuple(_applied(name, scenario, plan, random) for name in names))
    return _life(scenario).cut(plan.windows)


def _scenario(plan: Experiment, thermistor_noise: float, random: np.random.Generator) -> Scenario:
    axes = {"z": _axis(random, span=5000.0 * random.uniform(0.9, 1.1), still=STANDARD_GRAVITY)}
    if "lateral" in plan.parts:
        axes["y"] = _axis(random, span=random.uniform(-400.0, 400.0), still=0.0)
    return Scenario(
        name="loop",
        seed=int(random.integers(2**31)),
        sensor_id="loop_link",
        oven=_oven(plan, random),
        thermistor_rate=1.0,
        thermistor_noise=thermistor_noise,
        accelerometer_rate=RATE,
        axes=axes,
        second_thermometer=_second(plan, random) if "heating" in plan.parts else None,
        supply=_supply(plan, random) if "supply" in plan.parts else None,
        powered=plan.powered,
        motion=Motion(plan.orientations, plan.shocks, plan.vibrations),
        ground_truth=True,
    )


def _axis(random: np.random.Generator, span: float, still: float) -> Axis:
    return Axis(
        true_value=still,
        drift_span=span * STANDARD_GRAVITY,
        rate_drift=random.uniform(3.0, 12.0) * STANDARD_GRAVITY,
        white_noise=WHITE_NOISE,
        bias_instability=random.uniform(0.3, 0.7) * STANDARD_GRAVITY,
    )


def _oven(plan: Experiment, random: np.random.Generator) -> Oven:
    ripple = Ripple(random.uniform(0.05, 0.2), random.uniform(150.0, 400.0)) if random.integers(2) else None
    chamber, sensor = random.uniform(10.0, 30.0), random.uniform(20.0, 60.0)
    return Oven(25.0, sensor, plan.steps, chamber, ripple)


def _second(plan: Experiment, random: np.random.Generator) -> Thermometer:
    return Thermometer(1.0, 0.03, lag=random.uniform(20.0, 40.0), heating=plan.heating)


def _supply(plan: Experiment, random: np.random.Generator) -> Supply:
    wander, period = random.uniform(0.0, 0.01) * NOMINAL, random.uniform(3000.0, 6000.0)
    return Supply(1.0, NOMINAL, 0.002, wander, period, plan.voltage_steps)


def _applied(name: str, scenario: Scenario, plan: Experiment, random: np.random.Generator) -> AppliedEffect:
    """Return an effect with random parameters on z, of random size."""
    if not project_effects.RECIPES[name].sized:
        return AppliedEffect(name, _of_sensible_size(name, scenario, plan, random), ("z",))
    build = partial(project_effects.build, name, project_effects.draw(name, random))
    effects, heat = _alone(name, build(), scenario, plan)
    return AppliedEffect(name, build(scale=wanted_scale(name, effects, heat, random)), ("z",))


def _of_sensible_size(name: str, scenario: Scenario, plan: Experiment, random: np.random.Generator) -> Effect:
    for _ in range(DRAWS):
        effect = project_effects.build(name, project_effects.draw(name, random))
        if sensible(*_alone(name, effect, scenario, plan)):
            break
    return effect


def _alone(name: str, effect: Effect, scenario: Scenario, plan: Experiment) -> tuple[list[Array], list[Array]]:
    """Return the effect (n,) in m/s² and the temperature (n,) in °C of each recording."""
    applied = AppliedEffect(name, effect, ("z",))
    sensor, drift = _drift(replace(scenario, effects=(applied,)))
    added = drift - _drift(scenario)[1]
    on = power_state(plan.powered, sensor.time)
    rows = [on & (sensor.time >= start) & (sensor.time < end) for start, end in plan.windows]
    return [added[row] for row in rows], [sensor.temperature[row] for row in rows]


def _drift(scenario: Scenario) -> tuple[Sensor, Array]:
    """Return the sensor, powered or not, and the drift (n,) of its z axis."""
    sensor = Sensor(scenario, temperatures(scenario.oven), streams_of(scenario.seed))
    return sensor, sensor.drift("z")


def _life(scenario: Scenario) -> Life:
    made = simulate_with_truth(scenario)
    recording, truth = made.recording, made.truth
    sensor, without = _drift(replace(scenario, effects=()))
    drift = truth.drift[:, Z]
    effect = drift - without[power_state(scenario.powered, sensor.time)]
    return Life(
        stamps=recording.stamps,
        values=recording.values,
        present=recording.present,
        temperature=recording.temperature,
        temperature_2=recording.temperature_2,
        supply_voltage=recording.supply_voltage,
        truth=Truth(truth.temperature, drift, effect, truth.acceleration[:, Z]),
    )
