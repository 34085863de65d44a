"""Static drift of an axis: a map of the present temperature, and its rate term."""

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.simulation.description import Axis

Array = NDArray[np.float64]
LOWEST, HIGHEST, ZERO = -10.0, 60.0, 25.0
"""°C: range of the paper's oven test, and where the drift is zero."""


def static_drift(temperature: Array, axis: Axis) -> Array:
    """Return the drift (n,) at temperatures (n,): bent like a piezoresistive bridge's, monotone, no network.

    It changes by ``drift_span`` between -10 and 60 °C and is zero at 25 °C.
    """
    shape = _shape(temperature) - _shape(np.array(ZERO))
    low, high = _shape(np.array([LOWEST, HIGHEST]))
    return np.asarray(axis.drift_span * shape / (high - low))


def normalised(temperature: Array) -> Array:
    """Return x = (T − 25) / 35: -1...1 over the oven's range, the variable of every polynomial here."""
    return np.asarray((temperature - ZERO) / (HIGHEST - ZERO))


def _shape(temperature: Array) -> Array:
    x = normalised(temperature)
    return np.asarray(x + 0.25 * x**2 + 0.3 * np.tanh(1.5 * (x - 0.4)) - 0.1 * np.exp(-(x**2)))
