"""The effects in forms of a second simulator, of size about one; none is the form that is fitted."""

from collections.abc import Callable

import numpy as np
from scipy.special import erf

from benchmarks.loop.other_loops import bouc_wen, few_plays
from benchmarks.loop.other_world import STEP, Array, World, follow
from benchmarks.loop.project_effects import log_uniform, sign

Form = Callable[[World, np.random.Generator], Array]


def thermal_lag(around: World, random: np.random.Generator) -> Array:
    """Return f(two poles side by side) - f(T)."""
    share = random.uniform(0.5, 0.8)
    quick, late = log_uniform(random, 20.0, 100.0), log_uniform(random, 100.0, 250.0)
    lagged = share * follow(around.temperature, quick) + (1.0 - share) * follow(around.temperature, late)
    return around.static(lagged) - around.static(around.temperature)


def timing_offset(around: World, random: np.random.Generator) -> Array:
    """Return f(T(t - d)) - f(T), a d that drifts by some per cent."""
    delay = log_uniform(random, 30.0, 120.0) * (1.0 + 0.03 * np.sin(around.time / 20000.0))
    return around.static(np.interp(around.time - delay, around.time, around.temperature)) - around.static(
        around.temperature
    )


def hysteresis(around: World, random: np.random.Generator) -> Array:
    """Return a Bouc-Wen loop, or the sum of three plays."""
    make = bouc_wen if random.integers(2) else few_plays
    return sign(random) * make(around.temperature, random)


def warm_up(around: World, random: np.random.Generator) -> Array:
    """Return two exponentials after power-on, a quick one and a slow one; a short break cools only in part."""
    on = np.r_[0.0, around.powered.astype(np.float64)]
    quick, late = follow(on, random.uniform(60.0, 200.0))[1:], follow(on, log_uniform(random, 400.0, 1500.0))[1:]
    return sign(random) * (1.0 - late + random.uniform(0.1, 0.5) * (1.0 - quick))


def aging(around: World, random: np.random.Generator) -> Array:
    """Return a power of time, or its logarithm."""
    hours = around.time / 3600.0
    if random.integers(2):
        return np.asarray(sign(random) * np.log1p(hours / random.uniform(1.0, 6.0)))
    return np.asarray(sign(random) * hours ** random.uniform(0.6, 1.1))


def stress_relaxation(around: World, random: np.random.Generator) -> Array:
    """Return creep with two times, one of quarters of an hour, one of hours."""
    quick, late = log_uniform(random, 800.0, 2000.0), log_uniform(random, 3000.0, 8000.0)
    share, heat = random.uniform(0.4, 0.8), around.temperature
    return sign(random) * (heat - share * follow(heat, quick) - (1.0 - share) * follow(heat, late))


def thermal_gradient(around: World, random: np.random.Generator) -> Array:
    """Return the bending by T2 - T1, slightly curved."""
    difference = around.package - around.temperature
    return np.asarray(sign(random) * difference * (1.0 + random.uniform(0.0, 0.03) * np.abs(difference)))


def supply_voltage(around: World, random: np.random.Generator) -> Array:
    """Return what follows the supply, more when it is cold or hot, slightly curved."""
    relative = around.voltage / 0.1
    return sign(random) * relative * (1.0 + random.uniform(-0.4, 0.4) * around.x + random.uniform(0.0, 0.05) * relative)


def scale_factor_temperature(around: World, random: np.random.Generator) -> Array:
    """Return the input times a scale factor that falls exponentially with temperature."""
    return around.z * np.expm1(sign(random) * random.uniform(0.001, 0.003) * (around.temperature - 25.0))


def quadratic_nonlinearity(around: World, random: np.random.Generator) -> Array:
    """Return an even response that flattens at large inputs."""
    size = around.z / 1e4
    return np.asarray(sign(random) * size**2 / (1.0 + random.uniform(0.0, 0.2) * np.abs(size)))


def vibration_rectification(around: World, random: np.random.Generator) -> Array:
    """Return a bias that grows with the vibration's power, somewhat less than in proportion, after a delay."""
    power = around.power / 1e6
    return sign(random) * follow(power ** random.uniform(0.9, 1.0), random.uniform(1.0, 15.0))


def post_shock_zero_shift(around: World, random: np.random.Generator) -> Array:
    """Return a zero that shocks move: for good, and for minutes with two times."""
    stays, goes, power = random.uniform(0.5, 1.5), random.uniform(0.0, 1.0), random.uniform(0.9, 1.1)
    quick, late, total = random.uniform(30.0, 120.0), random.uniform(300.0, 900.0), np.zeros_like(around.time)
    for time, peak in around.shocks:
        since = np.maximum(around.time - time - 3 * STEP, 0.0)
        shape = stays + goes * (0.5 * np.exp(-since / quick) + 0.5 * np.exp(-since / late))
        total += np.where(around.time >= time + 3 * STEP, np.sign(peak) * np.abs(peak / 1e4) ** power * shape, 0.0)
    return sign(random) * total


def threshold_step(around: World, random: np.random.Generator) -> Array:
    """Return a step at a temperature, an error function in shape."""
    return sign(random) * erf((around.temperature - random.uniform(18.0, 32.0)) / random.uniform(0.1, 0.3))


def periodic_interference(around: World, random: np.random.Generator) -> Array:
    """Return a line with a second harmonic."""
    phase = 2.0 * np.pi * around.time / log_uniform(random, 40.0, 350.0) + random.uniform(0.0, 6.28)
    return np.asarray(np.sin(phase) + random.uniform(0.0, 0.25) * np.sin(2.0 * phase + 1.0))


def cross_axis(around: World, random: np.random.Generator) -> Array:
    """Return a share of y, which changes a little with temperature."""
    return sign(random) * around.y / 1e4 * (1.0 + random.uniform(-0.1, 0.1) * around.x)


FORMS: dict[str, Form] = {
    form.__name__: form
    for form in (
        thermal_lag,
        timing_offset,
        hysteresis,
        warm_up,
        aging,
        stress_relaxation,
        thermal_gradient,
        supply_voltage,
        scale_factor_temperature,
        quadratic_nonlinearity,
        vibration_rectification,
        post_shock_zero_shift,
        threshold_step,
        periodic_interference,
        cross_axis,
    )
}

WITHOUT_SIZE = ("thermal_lag", "timing_offset")
"""Effects whose size follows from their times alone."""
