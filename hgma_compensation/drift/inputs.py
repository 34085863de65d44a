"""Standardised inputs of a drift model."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class InputScaling:
    """Affine map of the features onto numbers of order one.

    offset, scale: shape (d,), in the units of the features.
    """

    offset: Array
    scale: Array

    def apply(self, features: Array) -> Array:
        """Return (features - offset) / scale, shape (n, d)."""
        return (features - self.offset) / self.scale

    @classmethod
    def of(cls, features: Array) -> "InputScaling":
        """Return the scaling to zero mean and unit variance; a constant feature keeps its unit."""
        spread = features.std(axis=0)
        return cls(features.mean(axis=0), np.where(spread > 0.0, spread, 1.0))


def weighted_sum(columns: Array, weights: Array) -> Array:
    """Return columns @ weights, shape (n,), with a result for each row that no other row changes.

    A matrix product would be faster, but BLAS orders its sums by the shape of the whole matrix: the
    same sample would differ in its last bits between a stream and a batch.
    """
    product = np.ascontiguousarray(columns * weights)
    return np.asarray(np.add.reduce(product, axis=1))
