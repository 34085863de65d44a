"""Examples of every effect and conditions made by hand, for the tests of effects; and that none is missing."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from hgma_compensation.channels import CHANNELS
from hgma_compensation.effects.conditions import Conditions
from hgma_compensation.effects.effect import Effect, Survey
from hgma_compensation.effects.registry import kinds, make
from hgma_compensation.stamps import NANOSECONDS, Stamps

Array = NDArray[np.float64]
EPOCH = 1_700_000_000 * NANOSECONDS
AXIS = "linear_acceleration.y"
MAP = {"lowest": -10.0, "highest": 60.0, "centres": 8.0}

EXAMPLES: dict[str, dict[str, float | str]] = {
    "aging": {"onset": 1000.0, "origin": float(EPOCH), "limit": 5000.0},
    "cross_axis": {"source": "linear_acceleration.z"},
    "hysteresis": {"threshold": 3.0, "spread": 2.0, "bend": 1.0, "plays": 3.0, "before": 20.0, "offset": 0.5},
    "periodic_interference": {"period": 120.0, "origin": float(EPOCH), "harmonics": 2.0, "from_power_on": 0.0},
    "post_shock_zero_shift": {"threshold": 20.0, "time_constant": 300.0, "channel": AXIS},
    "quadratic_nonlinearity": {"channel": AXIS},
    "rate_dependent_hysteresis": {"exponent": 0.5, "rate_floor": 1e-4},
    "scale_factor_temperature": {"channel": AXIS},
    "stress_relaxation": {"time_constant": 3000.0, "spread": 3.0},
    "supply_voltage": {"nominal": 3.3},
    "thermal_gradient": {},
    "thermal_lag": {"time_constant": 90.0, **MAP, "spread": 4.0, "poles": 2.0},
    "threshold_step": {"temperature": 30.0, "width": 0.4},
    "timing_offset": {"delay": 5.0, **MAP},
    "vibration_rectification": {"time_constant": 10.0, "floor": 0.2, "channel": AXIS},
    "warm_up": {"time_constant": 600.0, "spread": 3.0},
}
SURVEY = Survey(AXIS, (CHANNELS[0], CHANNELS[2], CHANNELS[3]), -10.0, 60.0, 46800.0, 10.0, 0.033, 0.5, EPOCH, 3.3)


def example(name: str) -> Effect:
    """Return the example of a kind of effect."""
    assert name in EXAMPLES, f"the effect {name} is new: give it an example here"
    return make(name, EXAMPLES[name])


def stamps_at(seconds: Array) -> Stamps:
    """Return times in s as stamps in ns."""
    return EPOCH + np.rint(seconds * NANOSECONDS).astype(np.int64)


def conditions(seconds: Array, temperature: Callable[[Array], Array], **inputs: Array) -> Conditions:
    """Return conditions under a temperature, °C, of the time, s; inputs replace what is else 0 or unknown."""
    count, silent = len(seconds), np.full(len(seconds), np.nan)
    half = 1e-3
    at = Conditions(
        stamps=stamps_at(seconds),
        since_power_on=seconds,
        temperature=temperature(seconds),
        rate=(temperature(seconds + half) - temperature(seconds - half)) / (2.0 * half),
        earlier=lambda delay: temperature(seconds - delay),
        temperature_2=silent,
        supply_voltage=silent,
        acceleration=np.zeros((count, len(CHANNELS))),
    )
    return replace(at, **inputs)  # type: ignore[arg-type]


def row(at: Conditions, index: int) -> Conditions:
    """Return the conditions of one sample."""
    one = slice(index, index + 1)
    arrays = {name: value[one] for name, value in vars(at).items() if name != "earlier"}
    return Conditions(earlier=lambda delay: at.earlier(delay)[one], **arrays)


def wild(count: int = 400, seed: int = 3) -> Conditions:
    """Return irregular samples of everything: ramps with ripple, gaps of other sensors, vibration and shocks."""
    random = np.random.default_rng(seed)
    seconds = np.cumsum(random.choice([0.01, 1.0, 7.3, 40.0], count) * random.uniform(0.5, 1.5, count))
    acceleration = random.normal(0.0, 0.5, (count, len(CHANNELS)))
    acceleration[random.random(count) < 0.02, 1] += 500.0
    gradient = random.normal(0.0, 1.0, count)
    gradient[random.random(count) < 0.1] = np.nan
    voltage = random.choice([3.2, 3.3, 3.4, np.nan], count)

    def oven(time: Array) -> Array:
        return np.asarray(25.0 + 34.0 * np.sin(time / 1500.0) + 0.5 * np.sin(time / 30.0))

    at = conditions(seconds, oven, supply_voltage=voltage, acceleration=acceleration)
    # Columns of wider arrays, as they come from a pipeline: steps of memory must not change a bit either.
    return replace(
        at,
        since_power_on=np.repeat(at.since_power_on, 3)[::3],
        temperature=np.repeat(at.temperature, 3)[::3],
        rate=np.repeat(at.rate, 3)[::3],
        temperature_2=at.temperature + gradient,
    )


def states(effect: Effect, at: Conditions) -> Array:
    """Return the states (n, m) of the effect's memory, moved on sample by sample."""
    of_acceleration = effect.acceleration_memory()
    if of_acceleration is not None:
        return of_acceleration.run(of_acceleration.start(), at.stamps, at.acceleration[:, CHANNELS.index(AXIS)])
    memory = effect.memory()
    if memory is None or not len(at):
        return np.empty((len(at), 0 if memory is None else memory.size))
    state = memory.start(at.temperature[:1])
    moved = np.empty((len(at), memory.size))
    steps = np.diff(at.stamps, prepend=at.stamps[:1]) * 1e-9
    for index, (step, temperature) in enumerate(zip(steps, at.temperature, strict=True)):
        before = at.temperature[max(index - 1, 0)]
        state = memory.advance(state[None], np.array([[step]]), np.array([[before]]), np.array([[temperature]]))[0]
        moved[index] = state
    return moved


def columns(effect: Effect, at: Conditions) -> Array:
    """Return the columns (n, k) of an effect, its memory having started with the first sample."""
    return effect.columns(at, states(effect, at))


@pytest.mark.parametrize("name", kinds())
def test_every_effect_has_an_example(name: str) -> None:
    assert isinstance(example(name), kinds()[name])


def test_every_example_is_of_an_effect() -> None:
    assert sorted(EXAMPLES) == list(kinds())
