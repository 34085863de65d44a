"""Polynomial drift: the cubic in temperature that PX4 and ArduPilot fit, and its kin with rate terms."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.drift.inputs import Array, InputScaling, weighted_sum

CUBIC = np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0]])
"""Exponents of (T, Ṫ, T·ΔT): 1, T, T², T³ (PX4 "thermal calibration", ArduPilot "IMU temperature calibration")."""

CUBIC_WITH_RATE = np.vstack([CUBIC, [[0, 1, 0], [1, 1, 0]]])
"""The cubic with Ṫ and T·Ṫ."""


def monomials(inputs: Array, exponents: NDArray[np.int64]) -> Array:
    """Return the products of powers, shape (n, k), of inputs (n, d) under exponents (k, d)."""
    columns = np.ones((len(inputs), len(exponents)))
    for column, powers in enumerate(exponents.tolist()):
        for variable, power in enumerate(powers):
            for _ in range(power):
                columns[:, column] *= inputs[:, variable]
    return columns


@dataclass(frozen=True)
class PolynomialDrift:
    """Drift = Σ kᵢ Π xⱼ^eᵢⱼ in scaled inputs x.

    exponents: (k, d) whole numbers. coefficients: (k,) in the channel's unit.
    """

    scaling: InputScaling
    exponents: NDArray[np.int64]
    coefficients: Array

    def evaluate(self, features: Array) -> Array:
        """Return the drift, shape (n,), at features of shape (n, d)."""
        return weighted_sum(monomials(self.scaling.apply(features), self.exponents), self.coefficients)
