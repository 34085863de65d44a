"""The Kalman gain, and the recursion of the variance that it makes."""

from collections.abc import Iterable
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

Number = TypeVar("Number", float, NDArray[np.float64])


def kalman_gain(predicted: Number, sample_variance: Number) -> Number:
    """Return K = V / (V + R) of a predicted variance V and that of the sample, R: Eq. (9).

    Written with operations that are monotone in V after rounding too, as K R is, the variance after the sample. So
    the variance at an even interval moves in one direction, and cannot cycle.
    """
    return 1.0 / (1.0 + sample_variance / predicted)


def riccati(variance: float, added: Iterable[float], sample_variances: Iterable[float]) -> list[float]:
    """Return the variance before the first and after each of n samples with Q and R, n of each: n + 1 numbers."""
    variances = [variance]
    append = variances.append
    for walk, white in zip(added, sample_variances, strict=True):
        variance = kalman_gain(variance + walk, white) * white
        append(variance)
    return variances
