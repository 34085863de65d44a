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
from scipy.linalg import cholesky

from hgma_compensation.diagnosis.whitener import Whitener
from hgma_compensation.stamps import Stamps

Array = NDArray[np.float64]

PER_DECADE = 3
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
        return self.whitener_of(self.correlated(run, stamps), spread)

    def correlated(self, run: NDArray[np.int64], stamps: Stamps) -> "list[Correlated]":
        """Return what the covariance of each run of blocks is made of: the same for any white noise and any flicker."""
        parts = []
        for number in np.unique(run):
            place = np.flatnonzero(run == number)
            seconds = (stamps[place] - stamps[place[0]]) * 1e-9
            apart = np.abs(seconds[:, None] - seconds[None, :])
            lags, own = np.arange(len(self.correlation)) * self.shortest, self.thermistor[place]
            carried = np.interp(apart, lags, self.correlation, right=0.0)
            carried *= own[:, None]  # in place: with two thousand means each of these is tens of megabytes
            carried *= own[None, :]
            parts.append(Correlated(place, flicker_correlation(apart, self.shortest, float(seconds[-1])), carried))
        return parts

    def whitener_of(self, parts: "Sequence[Correlated]", spread: Array | None = None) -> Whitener:
        """Return the whitener of runs; parts: as ``correlated`` gives them for the same thermistor."""
        factors = []
        for part in parts:
            covariance = self.flicker * part.flicker
            covariance += part.thermistor
            covariance[np.diag_indices(len(part.place))] += self.white[part.place] + 1e-9 * np.mean(self.white)
            if spread is not None:
                covariance += spread[part.place] @ spread[part.place].T
            factors.append(cholesky(covariance, lower=True, check_finite=False))
        return Whitener(tuple(factors), tuple(part.place for part in parts))


@dataclass(frozen=True)
class Correlated:
    """Of one run of blocks, place (n,): correlation of the flicker and covariance of the thermistor's part, (n, n)."""

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
    q, r = np.linalg.qr(whitener(nuisance))
    white = whitener(target)
    left = white - q @ (q.T @ white)
    diagonal: Any = np.abs(np.diag(r))
    return float(-0.5 * (whitener.log_determinant + 2.0 * np.log(diagonal[diagonal > 0]).sum() + left @ left))


def slow_cosines(run: NDArray[np.int64], stamps: Stamps, shortest_period: float) -> Array:
    """Return cosines (n, k) over each run, from constant to the shortest period (s)."""
    parts = []
    for number in np.unique(run):
        rows = run == number
        seconds = (stamps[rows] - stamps[rows][0]) * 1e-9
        length = float(seconds[-1]) + 1e-9
        count = 1 + int(2.0 * length / shortest_period)
        block = np.zeros((len(run), count))
        block[rows] = np.cos(np.pi * np.arange(count) * (seconds / length)[:, None])
        parts.append(block)
    return np.concatenate(parts, axis=1)
