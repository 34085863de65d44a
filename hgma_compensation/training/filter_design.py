"""Noise of the Kalman stage from a recording."""

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.errors import RefusedError
from hgma_compensation.kalman.random_walk import RandomWalkNoise
from hgma_compensation.kalman.settings import FilterMode, FilterSettings
from hgma_compensation.stamps import NANOSECONDS, Stamps
from hgma_compensation.training.blocks import noise_of_means


def design_filter(
    mode: FilterMode, time_constant: float, stamps: Stamps, values: NDArray[np.float64], channel: str
) -> FilterSettings:
    """Return the settings of one channel's stage.

    stamps, values: samples (n,) of the channel; their white noise gives R of Eq. (9). time_constant:
    s over which the settled filter averages; the longer it is, the less noise and the more lag.
    """
    if mode is FilterMode.OFF:
        return FilterSettings()
    interval = float(np.median(np.diff(stamps))) / NANOSECONDS
    white = noise_of_means(values[np.isfinite(values)]) * np.sqrt(max(interval, 0.0))
    if not white > 0.0:
        raise RefusedError(f"{channel} has no noise that a filter could smooth: train it with --filter off")
    return FilterSettings(mode, RandomWalkNoise.with_time_constant(float(white), time_constant))
