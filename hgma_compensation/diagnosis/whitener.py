"""Takes the correlation of the noise away, by the Cholesky factors of its covariance."""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_triangular

from hgma_compensation.recording.spooled import Spooled

Array = NDArray[np.float64]


class Whitener:
    """Cholesky factors of the covariance of each run; runs are independent of each other."""

    def __init__(self, factors: Sequence[Array], places: Sequence[NDArray[np.int64]]) -> None:
        """Take the factors (n, n), lower, and the places (n,) of their rows."""
        self.places = tuple(places)
        self._factors: tuple[Array | _Filed, ...] = tuple(factors)

    def __call__(self, columns: Array) -> Array:
        """Return L⁻¹ columns; (n,) or (n, k)."""
        white = np.empty_like(columns)
        for factor, place in zip(self.factors, self.places, strict=True):
            white[place] = solve_triangular(factor, columns[place], lower=True, check_finite=False)
        return white

    @property
    def factors(self) -> Iterator[Array]:
        """Yield the factors."""
        return (factor.read() if isinstance(factor, _Filed) else factor for factor in self._factors)

    @property
    def log_determinant(self) -> float:
        """Ln |C|."""
        return float(sum(2.0 * np.log(np.diag(factor)).sum() for factor in self.factors))

    def put_away(self) -> None:
        """Keep the factors in files from now on, tens of megabytes each; every use reads them again."""
        self._factors = tuple(f if isinstance(f, _Filed) else _Filed(f) for f in self._factors)


class _Filed:
    """An array (n, n) in a file, in the order of its bytes: another one would be another order of summation."""

    def __init__(self, array: Array) -> None:
        self._transposed = not array.flags.c_contiguous
        self._rows = Spooled(len(array))
        self._rows.add(array.T if self._transposed else array)

    def read(self) -> Array:
        array: Array = self._rows[:]
        return array.T if self._transposed else array
