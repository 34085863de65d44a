"""Noise of the block means: white, flicker, and the thermistor's error carried through the drift's slope.

The residual's noise is correlated, so an ordinary F test finds an effect in every recording. Here the
covariance is written down with two levels read off the data, and everything is judged after whitening by its
Cholesky factor (generalised least squares, Aitken 1936).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cholesky, qr

from hgma_compensation.diagnosis.factor import Factor
from hgma_compensation.diagnosis.whitener import Whitener
from hgma_compensation.kept_memory import give_back
from hgma_compensation.recording.sliced import in_parts
from hgma_compensation.stamps import Stamps

Array = NDArray[np.float64]

PER_DECADE = 3
ROWS = 32
"""Of a covariance that are formed at once."""

LONGEST = 10.0
"""Relaxation times of the flicker reach ten times beyond a run: a level that differs from run to run."""


@dataclass(frozen=True)
class NoiseModel:
    """white: (n,) variance of each mean. flicker: h, variance per e-fold of relaxation time (B²·/π).

    thermistor: (n,) deviation that the temperature's error brings to each mean. correlation: of that error,
    (lags,) at multiples of the block. shortest: s, the shortest relaxation time.
    """

    white: Array
    flicker: float
    thermistor: Array
    correlation: Array
    shortest: float

    def whitener(self, run: NDArray[np.int64], stamps: Stamps, spread: Array | None = None) -> Whitener:
        """Return the whitener of blocks: run (n,), stamps (n,) in ns; spread (n, r): further covariance, of spreadᵀ.

        What the spread of different runs has in common is left out.
        """
        places = _places(run)
        give_back()  # what stages before have left free, before the largest arrays of all are formed
        return Whitener([Factor(self._formed(place, stamps, spread)) for place in places], places)

    def _formed(self, place: NDArray[np.int64], stamps: Stamps, spread: Array | None) -> Array:
        """Return the Cholesky factor (n, n) of one run."""
        # By Fortran's columns, which LAPACK factorises where they are; a few rows at a time, so that no other
        # array of that size, tens of megabytes with two thousand means, is there beside it.
        covariance = np.empty((len(place), len(place)), order="F")
        for rows in in_parts(len(place), ROWS):
            part = self._correlated(place, stamps, rows)
            covariance[rows] = self.flicker * part.flicker + part.thermistor
        return self._factor(covariance, place, spread)

    def correlated(self, run: NDArray[np.int64], stamps: Stamps) -> "list[Correlated]":
        """Return what the covariance of each run of blocks is made of: the same for any white noise and any flicker."""
        return [self._correlated(place, stamps, slice(0, len(place))) for place in _places(run)]

    def whitener_of(self, parts: "Sequence[Correlated]") -> Whitener:
        """Return the whitener of runs; parts: as ``correlated`` gives them for the same thermistor."""
        factors = [self._factor(self.flicker * part.flicker + part.thermistor, part.place, None) for part in parts]
        return Whitener(factors, [part.place for part in parts])

    def _correlated(self, place: NDArray[np.int64], stamps: Stamps, rows: slice) -> "Correlated":
        seconds = (stamps[place] - stamps[place[0]]) * 1e-9
        apart = np.abs(seconds[rows, None] - seconds[None, :])
        lags, own = np.arange(len(self.correlation)) * self.shortest, self.thermistor[place]
        carried = np.interp(apart, lags, self.correlation, right=0.0) * own[rows, None] * own[None, :]
        return Correlated(place, flicker_correlation(apart, self.shortest, float(seconds[-1])), carried)

    def _factor(self, covariance: Array, place: NDArray[np.int64], spread: Array | None) -> Array:
        """Return the Cholesky factor of a covariance (n, n) of correlated noise, white noise and spread added to it."""
        covariance[np.diag_indices(len(place))] += self.white[place] + 1e-9 * np.mean(self.white)
        if spread is not None:
            covariance += spread[place] @ spread[place].T
        return np.asarray(cholesky(covariance, lower=True, overwrite_a=True, check_finite=False))


def _places(run: NDArray[np.int64]) -> list[NDArray[np.int64]]:
    return [np.flatnonzero(run == number) for number in np.unique(run)]


@dataclass(frozen=True)
class Correlated:
    """Of one run of blocks, place (n,): correlation of the flicker and covariance of the thermistor's part, (m, n).

    m: all of them, or some.
    """

    place: NDArray[np.int64]
    flicker: Array
    thermistor: Array


def flicker_correlation(apart: Array, shortest: float, duration: float) -> Array:
    """Return Σ e^(−|t|/τ)·Δ(ln τ) over log-spaced τ: 1/f noise of unit strength (van der Ziel 1950)."""
    times = flicker_times(shortest, duration)
    # Interpolated from a table: exponentials of a thousand by a thousand intervals and twenty times take a second.
    grid = np.concatenate([[0.0], np.geomspace(0.2 * shortest, max(duration, shortest) * 1.01, 400)])
    table = np.exp(-grid[:, None] / times).sum(axis=1) * np.log(10.0) / PER_DECADE
    return np.interp(apart, grid, table)


def flicker_times(shortest: float, duration: float) -> Array:
    """Return the relaxation times, s."""
    decades = np.log10(LONGEST * max(duration, shortest) / shortest)
    return np.asarray(shortest * 10.0 ** (np.arange(int(np.ceil(decades * PER_DECADE)) + 1) / PER_DECADE))


def restricted_log_likelihood(whitener: Whitener, target: Array, nuisance: Array) -> float:
    """Return the restricted log-likelihood (Patterson and Thompson 1971) of a target (n,), nuisance (n, k)."""
    q, r = qr_in_place(np.asfortranarray(whitener(nuisance)))
    white = whitener(target)
    left = white - q @ (q.T @ white)
    diagonal: Any = np.abs(np.diag(r))
    return float(-0.5 * (whitener.log_determinant + 2.0 * np.log(diagonal[diagonal > 0]).sum() + left @ left))


def qr_in_place(columns: Array) -> tuple[Array, Array]:
    """Return Q (n, k) and R (k, k) of columns (n, k) in Fortran's order, which are lost.

    numpy's takes four times their memory, megabytes for the slow change of a day; the bits are the same.
    """
    q, r = qr(columns, overwrite_a=True, mode="economic", check_finite=False)
    return np.ascontiguousarray(q), r


def slow_cosines(run: NDArray[np.int64], stamps: Stamps, shortest_period: float) -> Array:
    """Return cosines (n, k) over each run, from constant to the shortest period (s)."""
    parts = []
    for number in np.unique(run):
        rows = run == number
        seconds = (stamps[rows] - stamps[rows][0]) * 1e-9
        length = float(seconds[-1]) + 1e-9
        count = 1 + int(2.0 * length / shortest_period)
        waves = np.pi * np.arange(count) * (seconds / length)[:, None]
        np.cos(waves, out=waves)  # of a day each copy is megabytes
        if rows.all():
            return waves
        block = np.zeros((len(run), count))
        block[rows] = waves
        parts.append(block)
    return np.concatenate(parts, axis=1)
