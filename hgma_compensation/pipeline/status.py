"""What the temperature is worth at a sample; the numbers are those of hgma_msgs/CompensationState."""

from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.temperature.features import Features, FeatureSettings


class TemperatureStatus(IntEnum):
    """OK, or the first reason in this order of severity why the drift may be off."""

    OK = 0
    SETTLING = 1
    STALE = 2
    MISSING = 3
    OUT_OF_RANGE = 4
    INVALID = 5


UNUSABLE = frozenset(
    (TemperatureStatus.STALE, TemperatureStatus.MISSING, TemperatureStatus.OUT_OF_RANGE, TemperatureStatus.INVALID)
)
"""Those in which the drift is held; in SETTLING it is approximate."""


def temperature_status(
    features: Features, settings: FeatureSettings, inside_range: NDArray[np.bool_]
) -> NDArray[np.uint8]:
    """Return the status of each sample, shape (n,); inside_range: (n,) whether its features lie in the box.

    MISSING before the first thermistor sample; STALE when the newest is older than the prediction
    horizon; SETTLING until the history since the power-on covers the delay of ΔT; OUT_OF_RANGE outside the calibrated
    box; INVALID where the newest thermistor sample could not be used or looks broken, whatever else holds.
    """
    status = np.full(len(features.age), TemperatureStatus.OK, dtype=np.uint8)
    status[features.since_power_on < settings.delay] = TemperatureStatus.SETTLING
    status[~inside_range] = TemperatureStatus.OUT_OF_RANGE
    status[features.age > settings.prediction_horizon] = TemperatureStatus.STALE
    status[np.isinf(features.age)] = TemperatureStatus.MISSING
    status[features.unusable] = TemperatureStatus.INVALID
    return status
