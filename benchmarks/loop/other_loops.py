"""Rate-independent loops over temperature."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
EVERY = 5
"""The loops are followed at every fifth sample: once a second."""


def bouc_wen(temperature: Array, random: np.random.Generator) -> Array:
    """Return the internal variable (n,) of a Bouc-Wen model driven by a temperature (n,), -1...1.

    dz = (1 - |z|ⁿ (γ + β sgn(dT z))) dT/d, its width d of 3 to 10 °C.
    """
    width, exponent, beta = random.uniform(3.0, 10.0), random.uniform(1.0, 2.0), random.uniform(0.5, 0.9)
    state, states = 0.0, np.zeros(len(temperature[::EVERY]))
    for index, change in enumerate((np.diff(temperature[::EVERY]) / width).tolist()):
        turn = 1.0 - beta + (beta if change * state > 0.0 else -beta)
        state += (1.0 - turn * abs(state) ** exponent) * change
        states[index + 1] = state
    return _at_all(states, len(temperature))


def few_plays(temperature: Array, random: np.random.Generator) -> Array:
    """Return the weighted mean (n,) of play - T over three plays of 1 to 8 °C, in °C."""
    radii, weights = np.sort(random.uniform(1.0, 8.0, 3)), random.dirichlet([2.0, 2.0, 2.0])
    heat = temperature[::EVERY]
    loops = sum(weight * (play(heat, radius) - heat) for radius, weight in zip(radii, weights, strict=True))
    return _at_all(np.asarray(loops), len(temperature))


def play(temperature: Array, radius: float) -> Array:
    """Return w = min(max(w, T - r), T + r) (n,), at the first temperature to begin with."""
    states, state = np.empty(len(temperature)), float(temperature[0])
    for index, value in enumerate(temperature.tolist()):
        state = min(max(state, value - radius), value + radius)
        states[index] = state
    return states


def _at_all(values: Array, count: int) -> Array:
    return np.interp(np.arange(count), EVERY * np.arange(len(values)), values)
