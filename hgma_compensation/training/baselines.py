"""Gaussian process, thin-plate spline and kernel ridge on the network's features: offline comparison only.

They are too slow for a node and are never written to a calibration file, but they have ``evaluate`` as
every drift model has, so that the same pipeline and the same held-out cycle judge them. scikit-learn comes with
the extra "test": nothing that runs on a robot or trains a calibration needs it.
"""

import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.interpolate import RBFInterpolator
from sklearn.exceptions import ConvergenceWarning
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel
from sklearn.kernel_ridge import KernelRidge
from sklearn.model_selection import GridSearchCV, PredefinedSplit

from hgma_compensation.drift.inputs import Array, InputScaling
from hgma_compensation.training.folds import Folds

MOST_POINTS = 500
"""Means that process and spline are fitted to: their cost grows with the cube of it."""

SMOOTHING = tuple(float(s) for s in np.geomspace(1e-6, 1e2, 9))
"""Smoothing tried by the thin-plate spline, for inputs and target of unit variance."""

PENALTIES = tuple(float(a) for a in np.geomspace(1e-6, 1e-2, 5))
GAMMAS = tuple(float(g) for g in np.geomspace(1e-3, 1.0, 5))
"""Penalties and 1/(2σ²) tried by kernel ridge regression, for inputs and target of unit variance."""

CHUNK = 8192


@dataclass(frozen=True)
class GaussianProcessDrift:
    """Mean of the process, in the channel's unit."""

    scaling: InputScaling
    regressor: GaussianProcessRegressor
    unit: float

    def evaluate(self, features: Array) -> Array:
        """Return the drift (n,) at features (n, d)."""
        return _in_chunks(self.regressor.predict, self.scaling.apply(features)) * self.unit


@dataclass(frozen=True)
class ThinPlateDrift:
    """Smoothed thin-plate spline with linear terms, in the channel's unit."""

    scaling: InputScaling
    spline: RBFInterpolator
    unit: float
    smoothing: float

    def evaluate(self, features: Array) -> Array:
        """Return the drift (n,) at features (n, d)."""
        return _in_chunks(self.spline, self.scaling.apply(features)) * self.unit


@dataclass(frozen=True)
class KernelRidgeDrift:
    """Ridge regression with a squared-exponential kernel about the mean of the target, in the channel's unit."""

    scaling: InputScaling
    regressor: KernelRidge
    mean: float
    unit: float

    def evaluate(self, features: Array) -> Array:
        """Return the drift (n,) at features (n, d)."""
        return self.mean + _in_chunks(self.regressor.predict, self.scaling.apply(features)) * self.unit


def fit_gaussian_process(
    features: Array, target: Array, *, seed: int, points: int = MOST_POINTS
) -> GaussianProcessDrift:
    """Return a process with a squared-exponential kernel, one length for each input, and white noise.

    features: (n, d). target: (n,) drift. Fitted to at most ``points`` of them, drawn with the seed; lengths,
    variance and noise by maximum likelihood (Rasmussen and Williams 2006, chapter 5).
    """
    scaling, unit = InputScaling.of(features), float(target.std()) or 1.0
    rows = draw(len(target), points, seed)
    lengths = np.ones(features.shape[1])
    kernel = ConstantKernel(1.0, (1e-2, 1e4)) * RBF(lengths, (1e-1, 1e3)) + WhiteKernel(1e-4, (1e-9, 1e0))
    regressor = GaussianProcessRegressor(kernel, n_restarts_optimizer=1, random_state=seed)
    with warnings.catch_warnings():  # A length at its bound is an input that does not matter.
        warnings.simplefilter("ignore", ConvergenceWarning)
        regressor.fit(scaling.apply(features[rows]), target[rows] / unit)
    return GaussianProcessDrift(scaling, regressor, unit)


def fit_thin_plate(
    features: Array, target: Array, folds: Folds, *, seed: int, points: int = MOST_POINTS
) -> ThinPlateDrift:
    """Return the spline whose smoothing has the least RMS error on left-out folds.

    features: (n, d). target: (n,) drift. Fitted to at most ``points`` of them, drawn with the seed.
    """
    scaling, unit = InputScaling.of(features), float(target.std()) or 1.0
    rows = draw(len(target), points, seed)
    inputs, scaled, index = scaling.apply(features[rows]), target[rows] / unit, folds.index[rows]
    errors = [_left_out_rms(inputs, scaled, index, smoothing) for smoothing in SMOOTHING]
    best = SMOOTHING[int(np.argmin(errors))]
    return ThinPlateDrift(scaling, _spline(inputs, scaled, best), unit, best)


def fit_kernel_ridge(features: Array, target: Array, folds: Folds) -> KernelRidgeDrift:
    """Return the regression whose penalty and width have the least squared error on left-out folds.

    features: (n, d). target: (n,) drift. Fitted to all of them; one width for all inputs, as scikit-learn has it.
    """
    scaling, mean, unit = InputScaling.of(features), float(target.mean()), float(target.std()) or 1.0
    search = GridSearchCV(
        KernelRidge(kernel="rbf"),
        {"alpha": PENALTIES, "gamma": GAMMAS},
        cv=PredefinedSplit(folds.index),
        scoring="neg_mean_squared_error",
    )
    search.fit(scaling.apply(features), (target - mean) / unit)
    return KernelRidgeDrift(scaling, search.best_estimator_, mean, unit)


def draw(count: int, points: int, seed: int) -> Any:
    """Return the rows, in order, of at most ``points`` out of ``count``."""
    if count <= points:
        return np.arange(count)
    return np.sort(np.random.default_rng(seed).choice(count, points, replace=False))


def _spline(inputs: Array, target: Array, smoothing: float) -> RBFInterpolator:
    return RBFInterpolator(inputs, target, kernel="thin_plate_spline", smoothing=smoothing, degree=1)


def _left_out_rms(inputs: Array, target: Array, index: Any, smoothing: float) -> float:
    error = np.empty(len(target))
    for fold in np.unique(index):
        out = index == fold
        error[out] = target[out] - _spline(inputs[~out], target[~out], smoothing)(inputs[out])
    return float(np.sqrt(np.mean(error**2)))


def _in_chunks(function: Any, inputs: Array) -> Array:
    parts = [function(inputs[start : start + CHUNK]) for start in range(0, len(inputs), CHUNK)]
    return np.concatenate(parts) if parts else np.empty(0)
