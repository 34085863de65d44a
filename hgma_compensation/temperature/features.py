"""The inputs of the drift model: T, Ṫ and T·ΔT at the stamps of the accelerometer."""

from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.stamps import Stamps, to_nanoseconds
from hgma_compensation.temperature.track import TemperatureTrack
from hgma_compensation.temperature.trend_filter import TrendNoise
from hgma_compensation.temperature.updates import Updates

NAMES = ("temperature", "temperature_rate", "temperature_product")
UNITS = ("°C", "°C/s", "°C^2")


class Product(str, Enum):
    """How ΔT of the product T·ΔT is formed.

    DELAY: ΔT = T(t) - T(t - delay), which brings a second time constant into the model.
    REFERENCE: ΔT = T - T_ref, the paper's form. T·ΔT = T² - T_ref·T is then a function of T alone: a
    model that already has T as an input learns nothing from it. Kept so that the paper's network can
    be reproduced.
    """

    DELAY = "delay"
    REFERENCE = "reference"


@dataclass(frozen=True)
class FeatureSettings:
    """How the features are computed; stored in the calibration, so that training and node agree.

    noise: of the trend filter. product, delay (s), reference_temperature (°C): see Product.
    latency: s by which a thermistor sample must be older than an acceleration to be used for it. It
    costs nothing (the trend is predicted) and makes the result independent of the order in which
    messages of the two topics arrive. prediction_horizon: s over which the trend is extrapolated when
    the thermistor falls silent; after that it is held and called stale.
    """

    noise: TrendNoise
    product: Product = Product.DELAY
    delay: float = 60.0
    reference_temperature: float = 25.0
    latency: float = 0.1
    prediction_horizon: float = 10.0

    @property
    def history(self) -> float:
        """Seconds of thermistor history that a reading can reach back to."""
        return self.reach(self.delay)

    def reach(self, delay: float) -> float:
        """Return the seconds of history that a reading of the temperature ``delay`` s ago can reach back to."""
        return delay + self.latency + self.prediction_horizon


@dataclass(frozen=True)
class Features:
    """Features at n stamps.

    values: (n, 3), columns NAMES in UNITS; NaN where no thermistor sample has come yet.
    age: (n,) s since the thermistor sample used, infinite before the first.
    since_power_on: (n,) s since the first thermistor sample after the power-on, -infinity before the very first.
    unusable: (n,) whether the newest sample could not be used, or looks broken.
    """

    values: NDArray[np.float64]
    age: NDArray[np.float64]
    since_power_on: NDArray[np.float64]
    unusable: NDArray[np.bool_]


def read_features(
    track: TemperatureTrack | Updates, settings: FeatureSettings, stamps: Stamps, as_of: Stamps | None = None
) -> Features:
    """Evaluate the features at stamps (ns, shape (n,)); element by element, so n may be 1 or a day.

    as_of: (n,) ns, not after ``stamps``: what was known then decides, and the features are predicted from it.
    """
    latency, horizon = to_nanoseconds(settings.latency), settings.prediction_horizon
    temperature, rate, age = track.read(stamps, latency, horizon, as_of)
    if settings.product is Product.DELAY:
        difference = temperature - track.read_earlier(stamps, to_nanoseconds(settings.delay), latency, horizon, as_of)
    else:
        difference = temperature - settings.reference_temperature
    values = np.empty((len(stamps), len(NAMES)))
    values[:, 0] = temperature
    values[:, 1] = rate
    values[:, 2] = temperature * difference
    values[np.isinf(age)] = np.nan
    since_power_on = np.where(np.isinf(age), -np.inf, track.since_power_on(stamps, latency, as_of))
    return Features(values, age, since_power_on, track.last_is_unusable(stamps if as_of is None else as_of, latency))
