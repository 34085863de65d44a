"""What a simulated sensor really underwent, written beside its recording for whoever judges a compensation."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

TEMPERATURE_TOPIC = "/ground_truth/temperature"
ACCELERATION_TOPIC = "/ground_truth/acceleration"
DRIFT_TOPIC = "/ground_truth/drift"
DECLARED_EFFECTS = "hgma_declared_effects"
"""Key in the bag's custom data: JSON of the effects that the scenario declares."""


@dataclass(frozen=True)
class GroundTruth:
    """At the stamps of the accelerometer: temperature (n,) °C of the sensor, acceleration and drift (n, 3) m/s².

    declared: the effects that a judge may know of.
    """

    temperature: NDArray[np.float64]
    acceleration: NDArray[np.float64]
    drift: NDArray[np.float64]
    declared: tuple[Mapping[str, Any], ...] = ()
