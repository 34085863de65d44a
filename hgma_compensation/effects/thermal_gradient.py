"""Thermal gradient: one side of the package is warmer than the other."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from hgma_compensation.effects.conditions import Conditions
from hgma_compensation.effects.effect import Array, Effect, Need, Survey, normalised
from hgma_compensation.effects.registry import register


@register
@dataclass(frozen=True)
class ThermalGradient(Effect):
    """(T2 − T)·(k + c·x), x = (T − 25 °C)/35 °C (EFFECTS catalogue form)."""

    name = "thermal_gradient"
    title = "temperature gradient across the package"
    slow = True
    needs = (Need.TEMPERATURE_2,)
    identified_by = "a second thermometer, and heat from another side at the same temperature"
    confused_with = ("thermal_lag", "timing_offset")
    gain_unit = "/°C"

    @property
    def count(self) -> int:
        """The gradient, alone and times x."""
        return 2

    def columns(self, at: Conditions, state: Array) -> Array:
        """Return T2 − T, °C, and the same times x; 0 before its first sample."""
        gradient = np.where(np.isnan(at.temperature_2), 0.0, at.temperature_2 - at.temperature)
        return np.column_stack([gradient, gradient * normalised(at.temperature)])

    @classmethod
    def candidates(cls, survey: Survey) -> Iterator["ThermalGradient"]:
        """Yield the effect, which has no parameters."""
        yield cls()
