"""All that an effect may answer to, at n samples of the accelerometer."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.stamps import Stamps

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Conditions:
    """What was known when each of n samples was taken.

    stamps: (n,) ns. since_power_on: (n,) s. temperature: (n,) °C and rate: (n,) °C/s of the thermistor, inside the
    calibrated range. earlier: gives the temperature (n,) that many s before the samples.
    temperature_2: (n,) °C, supply_voltage: (n,) V, NaN where that input has not come.
    acceleration: (n, 6), columns CHANNELS: less the drift model and the reference where a channel is calibrated, raw
    elsewhere.
    """

    stamps: Stamps
    since_power_on: Array
    temperature: Array
    rate: Array
    earlier: Callable[[float], Array]
    temperature_2: Array
    supply_voltage: Array
    acceleration: Array

    def __len__(self) -> int:
        """Return n."""
        return len(self.stamps)
