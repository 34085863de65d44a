"""Levels of the noise model, read off the data."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from hgma_compensation.diagnosis.blocks import Blocks
from hgma_compensation.diagnosis.noise_model import NoiseModel, restricted_log_likelihood, slow_cosines
from hgma_compensation.diagnosis.runs import Run
from hgma_compensation.diagnosis.smoothing import smooth, thinned
from hgma_compensation.stamps import NANOSECONDS
from hgma_compensation.temperature.trend_filter import TrendNoise
from hgma_compensation.training.blocks import noise_of_means

Array = NDArray[np.float64]

SLOW = 600.0
"""s: flicker is read off fluctuations faster than this, where drift has little; slower ones are not asked."""

CHUNK = 300
"""Blocks whose covariance is formed at once while the level is searched."""

FLICKER_RANGE = (-9.0, 1.0)
"""ln of the flicker's strength over the white variance of a mean."""

NOISY = 4.0
"""A block whose own variance exceeds the typical one by this factor (vibration) counts with its own."""

LAGS = 12


@dataclass(frozen=True)
class ThermistorError:
    """deviation: of a block's mean temperature, °C. correlation: (lags,) of it at multiples of the block."""

    deviation: float
    correlation: Array


def thermistor_error(run: Run, noise: TrendNoise, block: float, random: np.random.Generator) -> ThermistorError:
    """Return what the thermistor's noise leaves in smoothed means of ``block`` s, by smoothing noise alone."""
    raw = run.recording.temperature
    interval = float(np.median(np.diff(raw.stamps)))
    per_block = max(1.0, block * NANOSECONDS / interval)
    count = int(min(max(600 * per_block, 2000), 40000))
    stamps = (np.arange(count) * interval).astype(np.int64)
    series = smooth(*thinned(stamps, np.sqrt(noise.measurement) * random.standard_normal(count), noise))
    index = np.floor(series.stamps / (block * NANOSECONDS)).astype(np.int64)
    means = np.bincount(index, series.temperature) / np.maximum(np.bincount(index), 1)
    means = means[5:-5]
    spectrum = np.array([np.mean(means[: len(means) - k] * means[k:]) for k in range(LAGS)])
    return ThermistorError(float(np.sqrt(spectrum[0])), _positive(spectrum / spectrum[0]))


def _positive(correlation: Array) -> Array:
    """Return the correlation tapered to zero, so that the matrix made of it stays positive definite."""
    return correlation * (1.0 - np.arange(len(correlation)) / len(correlation))


def fit_noise(
    blocks: Blocks, residual: Array, nuisance: Array, thermistor: tuple[Array, Array], block: float
) -> NoiseModel:
    """Return the noise model of a channel's blocks.

    residual: (n,) of a fit. nuisance: (n, k) that was fitted. thermistor: (deviation (n,) that the temperature's
    error brings, its correlation). block: s.
    """
    carried, correlation = thermistor
    white = white_variance(blocks, residual, carried)
    chunks = blocks.run * 100000 + np.arange(len(blocks)) // CHUNK
    slow = np.hstack([nuisance, slow_cosines(blocks.run, blocks.stamps, SLOW)])
    slow = slow[:, np.linalg.norm(slow, axis=0) > 0.0]

    def model(level: float) -> NoiseModel:
        return NoiseModel(white, float(np.exp(level) * np.median(white)), carried, correlation, block)

    parts = model(0.0).correlated(chunks, blocks.stamps)

    def cost(level: float) -> float:
        return -restricted_log_likelihood(model(level).whitener_of(parts), blocks.values, slow)

    best = minimize_scalar(cost, bounds=FLICKER_RANGE, method="bounded", options={"xatol": 0.15})
    return model(float(best.x))


def quiet_level(white: Array) -> float:
    """Return the typical variance of blocks in which nothing vibrates, given all of them (n,)."""
    low, high = np.quantile(white, (0.1, 0.9))
    return float(np.median(white[white <= np.sqrt(low * high)]) if high > NOISY * low else np.median(white))


def white_variance(blocks: Blocks, residual: Array, carried: Array) -> Array:
    """Return the white variance (n,) of each mean: one level for all but the noisy blocks."""
    typical = quiet_level(blocks.white)
    ratio = np.maximum(blocks.white / max(typical, 1e-300), 1.0)
    seen = noise_of_means(residual / np.sqrt(np.where(ratio > NOISY, ratio, 1.0))) ** 2
    # Second differences of the thermistor's share are nearly those of white noise.
    level = max(seen - float(np.median(carried**2)), 0.25 * typical, 1e-3 * seen)
    noisy = blocks.white > NOISY * typical
    return np.where(noisy, level * blocks.white / max(typical, 1e-300), level)
