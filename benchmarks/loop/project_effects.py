"""Effects of the project's own simulator with random parameters, of size one where they have a size."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from hgma_compensation.simulation.effect import Effect
from hgma_compensation.simulation.effects import EFFECTS

Draw = Callable[[np.random.Generator], Mapping[str, Any]]


@dataclass(frozen=True)
class Recipe:
    """draw: gives the parameters. sized: those that the size of the effect is proportional to, none if it has none."""

    draw: Draw
    sized: tuple[str, ...] = ()


def log_uniform(random: np.random.Generator, low: float, high: float) -> float:
    """Return a number whose logarithm is uniform."""
    return float(np.exp(random.uniform(np.log(low), np.log(high))))


def sign(random: np.random.Generator) -> float:
    """Return 1 or -1."""
    return 1.0 if random.integers(2) else -1.0


RECIPES: dict[str, Recipe] = {
    "thermal_lag": Recipe(
        lambda r: {"time_constant": log_uniform(r, 20.0, 150.0), "second_time_constant": r.uniform(0.0, 20.0)}
    ),
    "timing_offset": Recipe(lambda r: {"delay": log_uniform(r, 30.0, 120.0)}),
    "hysteresis": Recipe(
        lambda r: {"width": sign(r), "threshold": r.uniform(1.5, 5.0), "skew": r.uniform(0.0, 0.4)}, ("width",)
    ),
    "warm_up": Recipe(lambda r: {"amplitude": sign(r), "time_constant": log_uniform(r, 200.0, 1200.0)}, ("amplitude",)),
    "aging": Recipe(
        lambda r: {"rate": sign(r), "logarithmic_after": r.integers(2) * log_uniform(r, 3600.0, 28800.0)}, ("rate",)
    ),
    "stress_relaxation": Recipe(
        lambda r: {"gain": sign(r), "time_constant": log_uniform(r, 1000.0, 5000.0), "decades": r.uniform(0.0, 0.3)},
        ("gain",),
    ),
    "thermal_gradient": Recipe(lambda r: {"gain": sign(r), "bend": r.uniform(-0.3, 0.3)}, ("gain",)),
    "supply_voltage": Recipe(
        lambda r: {"gain": sign(r), "temperature_gain": r.uniform(-0.4, 0.4)}, ("gain", "temperature_gain")
    ),
    "scale_factor_temperature": Recipe(
        lambda r: {"linear": sign(r), "quadratic": r.uniform(-0.2, 0.2)}, ("linear", "quadratic")
    ),
    "quadratic_nonlinearity": Recipe(lambda r: {"fraction": sign(r), "level": 20000.0}, ("fraction",)),
    "vibration_rectification": Recipe(
        lambda r: {"coefficient": sign(r), "time_constant": r.uniform(1.0, 20.0)}, ("coefficient",)
    ),
    "post_shock_zero_shift": Recipe(
        lambda r: {
            "permanent": sign(r),
            "transient": r.uniform(0.0, 1.0),
            "time_constant": log_uniform(r, 100.0, 900.0),
        },
        ("permanent", "transient"),
    ),
    "threshold_step": Recipe(
        lambda r: {"temperature": r.uniform(20.0, 32.0), "height": sign(r), "width": r.uniform(0.3, 0.6)}, ("height",)
    ),
    "periodic_interference": Recipe(
        lambda r: {"amplitude": 1.0, "period": log_uniform(r, 40.0, 350.0), "phase": r.uniform(0.0, 6.28)},
        ("amplitude",),
    ),
    "cross_axis": Recipe(lambda r: {"source": "y", "gain": sign(r)}, ("gain",)),
    "random_walk": Recipe(lambda r: {"coefficient": 1.0}, ("coefficient",)),
    "telegraph_noise": Recipe(
        lambda r: {"amplitude": sign(r), "mean_low": r.uniform(200.0, 900.0), "mean_high": r.uniform(200.0, 900.0)},
        ("amplitude",),
    ),
    "humidity": Recipe(
        lambda r: {
            "gain": sign(r),
            "time_constant": r.uniform(1000.0, 3000.0),
            "swing": 10.0,
            "period": r.uniform(14400.0, 36000.0),
            "wander": 10.0,
        },
        ("gain",),
    ),
}


def draw(name: str, random: np.random.Generator) -> dict[str, Any]:
    """Return random parameters of an effect."""
    return dict(RECIPES[name].draw(random))


def build(name: str, parameters: Mapping[str, Any], scale: float = 1.0) -> Effect:
    """Return the effect, ``scale`` times as large where it has a size."""
    sized = RECIPES[name].sized
    return EFFECTS[name](**{key: value * scale if key in sized else value for key, value in parameters.items()})
