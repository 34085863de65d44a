"""Low-pass filters on evenly spaced samples, as the physics of heat and stress runs them."""

import numpy as np
from numpy.typing import NDArray
from scipy.signal import cont2discrete, lfilter

Array = NDArray[np.float64]


def low_pass(values: Array, time_constant: float, step: float) -> Array:
    """Return values (n,) through s += (1 − e^(−step/τ))(u − s), settled at the first one; τ = 0: unchanged."""
    if time_constant <= 0.0:
        return values
    keep = float(np.exp(-step / time_constant))
    follows, _ = lfilter([1.0 - keep], [1.0, -keep], values, zi=[keep * values[0]])
    return np.asarray(follows)


def resonance(values: Array, frequency: float, quality: float, step: float) -> Array:
    """Return values (n,) through 1 / (1 + s/(Qω) + s²/ω²), settled at the first one.

    Discretised by a first-order hold: exact where the input is straight between samples.
    """
    omega = 2.0 * np.pi * frequency
    system = ([1.0], [1.0 / omega**2, 1.0 / (quality * omega), 1.0])
    numerator, denominator, _ = cont2discrete(system, step, method="foh")
    responds = lfilter(numerator.ravel(), denominator, values - values[0])
    return np.asarray(values[0] + responds)
