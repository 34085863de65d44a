"""Quadratic nonlinearity of the transducer."""

from dataclasses import dataclass

import numpy as np

from hgma_compensation.effects.conditions import Conditions
from hgma_compensation.effects.effect import Array
from hgma_compensation.effects.input_driven import InputDriven
from hgma_compensation.effects.registry import register


@register
@dataclass(frozen=True)
class QuadraticNonlinearity(InputDriven):
    """k·a², a the channel's acceleration (second-order coefficient K2 of the model equation of IEEE Std 1293)."""

    name = "quadratic_nonlinearity"
    title = "quadratic nonlinearity"
    identified_by = "inputs of both signs at several levels"
    confused_with = ("scale_factor_temperature", "vibration_rectification")
    gain_unit = "/(m/s^2)^2"

    @property
    def count(self) -> int:
        """One column."""
        return 1

    def columns(self, at: Conditions, state: Array) -> Array:
        """Return a², (m/s²)²."""
        acceleration = self.acceleration(at)
        return np.asarray((acceleration * acceleration)[:, None])
