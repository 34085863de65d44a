"""Takes the correlation of the noise away, by the Cholesky factors of its covariance."""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.diagnosis.factor import Factor
from hgma_compensation.recording.sliced import in_parts

Array = NDArray[np.float64]

MANY = 128
"""Columns that are whitened at once. Of more of them reading a factor from its file is nothing beside solving, and the
memory is left to what they become."""


class Whitener:
    """Cholesky factors of the covariance of each run; runs are independent of each other."""

    def __init__(self, factors: Sequence[Array | Factor], places: Sequence[NDArray[np.int64]]) -> None:
        """Take the factors (n, n), lower, and the places (n,) of their rows."""
        self.places = tuple(places)
        self._factors = tuple(one if isinstance(one, Factor) else Factor(one) for one in factors)

    def __call__(self, columns: Array) -> Array:
        """Return L⁻¹ columns; (n,) or (n, k)."""
        white = np.empty_like(columns)
        for factor, place in zip(self._factors, self.places, strict=True):
            if columns.ndim == 1:
                white[place] = factor.solve(columns[place])
                continue
            for part in in_parts(columns.shape[1], MANY):
                white[place, part] = factor.solve(columns[place, part], held=columns.shape[1] < MANY)
        return white

    def expected(self, directions: Array) -> float:
        """Return the energy that noise has along directions (n, k) on average: Σ |Lᵀ d|²."""
        return sum(
            float(np.sum(factor.transposed(directions[place]) ** 2))
            for factor, place in zip(self._factors, self.places, strict=True)
        )

    @property
    def factors(self) -> Iterator[Array]:
        """Yield the factors (n, n), each formed when it is its turn."""
        return (factor.read() for factor in self._factors)

    @property
    def log_determinant(self) -> float:
        """Ln |C|."""
        return float(sum(2.0 * np.log(factor.diagonal).sum() for factor in self._factors))

    def put_away(self) -> None:
        """Keep the factors in files from now on; every use reads them again."""
        for factor in self._factors:
            factor.put_away()
