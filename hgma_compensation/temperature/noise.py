"""Noise of the thermistor and of the temperature's trend, by maximum likelihood.

The innovations of the right filter are white with the variance that it predicts (Schweppe 1965), so
the pair (q, r) is the one under which the recorded innovations are likeliest.
"""

from collections.abc import Sequence
from math import log

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from hgma_compensation.effects.memory import POWER_OFF
from hgma_compensation.stamps import Stamps, seconds_between, to_nanoseconds
from hgma_compensation.temperature.trend_filter import TrendFilter, TrendNoise

SETTLING_STEPS = 20
LONGEST_RUN = 4000
MOST_RUNS = 5
BOUNDS = ((1e-12, 1e0), (1e-8, 1e2))
"""Of q, (°C/s²)²·s, and of r, °C²: a tenth of a millidegree to ten degrees."""

Series = tuple[Stamps, NDArray[np.float64]]


def fit_trend_noise(recordings: Sequence[Series]) -> TrendNoise:
    """Return the noise of thermistor recordings, each (stamps in ns, °C), strictly increasing stamps.

    Long recordings are judged on a few runs spread evenly over them: two numbers need no more.
    """
    runs = [run for recording in recordings for run in _runs(recording)]
    second = np.concatenate([np.diff(values, 2) for _, values in runs])
    # White noise of variance r has second differences of variance 6 r; the median ignores the ramps.
    start_r = float(np.clip((np.median(np.abs(second)) / 0.6745) ** 2 / 6.0, *BOUNDS[1]))
    bounds = np.log(BOUNDS)

    def cost(logarithms: NDArray[np.float64]) -> float:
        q, r = np.exp(np.clip(logarithms, bounds[:, 0], bounds[:, 1]))
        return -sum(log_likelihood(run, TrendNoise(float(q), float(r))) for run in runs)

    start = np.log([1e-6, start_r])
    best = minimize(cost, start, method="Nelder-Mead", options={"xatol": 0.02, "fatol": 0.1, "maxiter": 120})
    q, r = np.exp(np.clip(best.x, bounds[:, 0], bounds[:, 1]))
    return TrendNoise(process=float(q), measurement=float(r))


def log_likelihood(series: Series, noise: TrendNoise) -> float:
    """Return the log-likelihood of one thermistor series, up to a constant; the filter starts anew at each power-on."""
    stamps, values = series
    before = np.concatenate([stamps[:1], stamps[:-1]])
    steps, off = seconds_between(stamps, before), stamps - before > to_nanoseconds(POWER_OFF)
    trend, total, number = TrendFilter(noise), 0.0, 0
    for dt, begins_anew, value in zip(steps.tolist(), off.tolist(), values.tolist(), strict=True):
        if begins_anew:
            trend.reset()
            number = 0
        step = trend.step(dt, value)
        number += 1
        if number > SETTLING_STEPS:
            total -= 0.5 * (log(step.innovation_variance) + step.innovation**2 / step.innovation_variance)
    return float(total)


def _runs(recording: Series) -> list[Series]:
    stamps, values = recording
    count = min(MOST_RUNS, -(-len(stamps) // LONGEST_RUN))
    length = min(LONGEST_RUN, len(stamps))
    starts = np.linspace(0, len(stamps) - length, count).astype(int)
    return [(stamps[s : s + length], values[s : s + length]) for s in starts]
