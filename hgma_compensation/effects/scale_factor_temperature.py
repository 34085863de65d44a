"""Scale factor that changes with temperature, as a piezoresistor's does."""

from dataclasses import dataclass

import numpy as np

from hgma_compensation.effects.conditions import Conditions
from hgma_compensation.effects.effect import Array, normalised
from hgma_compensation.effects.input_driven import InputDriven
from hgma_compensation.effects.registry import register


@register
@dataclass(frozen=True)
class ScaleFactorTemperature(InputDriven):
    """(k₁·x + k₂·x²)·a, a the channel's acceleration, x = (T − 25 °C)/35 °C (model equation of IEEE Std 1293)."""

    name = "scale_factor_temperature"
    title = "temperature coefficient of the scale factor"
    identified_by = "a known input of both signs at three temperatures or more"
    confused_with = ("quadratic_nonlinearity",)
    gain_unit = "/(m/s^2)"

    @property
    def count(self) -> int:
        """Linear and quadratic in temperature."""
        return 2

    def columns(self, at: Conditions, state: Array) -> Array:
        """Return x·a and x²·a, m/s²."""
        x = normalised(at.temperature)
        linear = x * self.acceleration(at)
        return np.column_stack([linear, x * linear])
