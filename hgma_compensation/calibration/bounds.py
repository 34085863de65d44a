"""How large what a calibration subtracts can become: bounds that hold everywhere, not only where one looked."""

from typing import cast

import numpy as np

from hgma_compensation.drift.inputs import Array, InputScaling
from hgma_compensation.drift.model import CalibratedRange, DriftModel
from hgma_compensation.drift.polynomial import PolynomialDrift, monomials
from hgma_compensation.drift.radial_basis import RadialBasisDrift

LARGEST_DRIFT = 1e12
"""m/s² and rad/s. A fit may have large weights that cancel each other; beyond this nothing of the signal is left."""

LARGEST_EFFECT = 1e100
"""The same of effects in the worst case of them all, which no sensor meets: there the arithmetic must still hold."""


def largest_drift(drift: DriftModel, box: CalibratedRange) -> float:
    """Return a bound on the magnitude of a drift model in the box; infinite or NaN where its numbers overflow.

    Every Gaussian lies in 0...1, and the magnitude of an input is largest at an end of its interval.
    """
    if isinstance(drift, RadialBasisDrift):
        inputs = _largest_inputs(drift.scaling, box)
        return float(np.abs(drift.weights).sum() + abs(drift.bias) + (np.abs(drift.linear) * inputs).sum())
    polynomial = cast(PolynomialDrift, drift)
    powers = monomials(_largest_inputs(polynomial.scaling, box)[None], polynomial.exponents)
    return float((np.abs(polynomial.coefficients) * powers[0]).sum())


def _largest_inputs(scaling: InputScaling, box: CalibratedRange) -> Array:
    """Return the largest magnitude (d,) of each scaled input."""
    return np.maximum(np.abs(scaling.apply(box.lower)), np.abs(scaling.apply(box.upper)))
