"""The error that remains to a perfect drift model: noise of the accelerometer and of the thermistor.

Only a simulation knows it: there the same recording exists without noise.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.stamps import Stamps, seconds_between
from hgma_compensation.training.blocks import group_means

Array = NDArray[np.float64]
DEGREE = 15
"""Of the polynomial whose derivative is the drift's slope over temperature."""


@dataclass(frozen=True)
class NoiseFloor:
    """RMS of means, in the channel's unit.

    accelerometer: its noise alone. with_thermistor: with the error of the causal temperature beside it, carried
    through the slope of the true drift; what a model that is exactly right would leave.
    """

    accelerometer: float
    with_thermistor: float


def noise_floor(
    stamps: Stamps, noise: Array, drift: Array, temperature: tuple[Array, Array], seconds: float
) -> NoiseFloor:
    """Return the floor of means over ``seconds``.

    stamps: (n,) ns. noise: (n,) of the accelerometer. drift: (n,) without noise. temperature: (true, estimated),
    each (n,) °C.
    """
    true, estimated = temperature
    index = np.floor(seconds_between(stamps, int(stamps[0])) / seconds).astype(np.int64)
    carried = noise - slope_over_temperature(true, drift) * (estimated - true)
    means = group_means(index, np.column_stack([noise, carried]))
    accelerometer, with_thermistor = np.sqrt(np.mean(means**2, axis=0)).tolist()
    return NoiseFloor(accelerometer, with_thermistor)


def slope_over_temperature(temperature: Array, drift: Array) -> Array:
    """Return d drift / dT, shape (n,), of a smooth fit that ignores what rate adds."""
    fit = np.polynomial.Chebyshev.fit(temperature, drift, DEGREE)
    return np.asarray(fit.deriv()(temperature))
