"""How large an effect is, and how large it shall be."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.recording.csv_table import STANDARD_GRAVITY

Array = NDArray[np.float64]

RATE = 5.0
"""Hz of the accelerometer."""

WHITE_NOISE = 4.76 * STANDARD_GRAVITY
"""m/s²/√Hz, the paper's velocity random walk."""

MEAN = 25
"""Samples in a mean of 5 s."""

FLOOR = WHITE_NOISE / np.sqrt(MEAN / RATE)
"""m/s², RMS of a mean of 5 s by white noise alone."""

VISIBLE = (3.0, 20.0)
"""Times FLOOR: RMS on the held-out recording of what a model of the present temperature cannot carry."""

VISIBLE_OF_TIMES = (2.5, 20.0)
"""The same for effects whose size follows from their times: a model with Ṫ takes over nearly all of a delay."""

VISIBLE_OF_INPUT = (3.0, 8.0)
"""The same for an error of the scale, which is a few per cent of an input that is seldom there."""

OF_INPUT = ("scale_factor_temperature", "quadratic_nonlinearity")

LARGEST = 50.0
"""Times FLOOR, RMS of the whole effect on the held-out recording: 2 % of the drift."""

DRAWS = 12
"""Times that parameters are drawn until the size is sensible."""

BACK = 12
"""Means that ΔT reaches back: 60 s."""

POWERS = 6
"""Of temperature in the model that stands for all models of the present temperature and its rate."""


def wanted_scale(
    name: str, effects: Sequence[Array], temperatures: Sequence[Array], random: np.random.Generator
) -> float:
    """Return the factor that gives an effect a random size, log-uniform in its range, its whole within LARGEST.

    effects, temperatures: (n,) of each recording, m/s² and °C, the held-out one last.
    """
    limits = VISIBLE_OF_INPUT if name in OF_INPUT else VISIBLE
    wanted = np.exp(random.uniform(*np.log(limits))) * FLOOR
    return float(min(wanted / visible(effects, temperatures), LARGEST * FLOOR / rms(whole(effects))))


def sensible(effects: Sequence[Array], temperatures: Sequence[Array]) -> bool:
    """Return whether the size of an effect that follows from its times is in VISIBLE_OF_TIMES."""
    return VISIBLE_OF_TIMES[0] <= visible(effects, temperatures) / FLOOR <= VISIBLE_OF_TIMES[1]


def whole(effects: Sequence[Array]) -> Array:
    """Return the effect (n,) on the held-out recording, less its mean over the others."""
    return np.asarray(effects[-1] - np.concatenate(list(effects[:-1])).mean())


def visible(effects: Sequence[Array], temperatures: Sequence[Array]) -> float:
    """Return the RMS on the held-out recording of what is left of an effect by a model fitted to the others."""
    pairs = [_equations(effect, heat) for effect, heat in zip(effects, temperatures, strict=True)]
    rows, targets = [columns for columns, _ in pairs], [target for _, target in pairs]
    fit = np.linalg.lstsq(np.concatenate(rows[:-1]), np.concatenate(targets[:-1]), rcond=None)[0]
    return rms(targets[-1] - rows[-1] @ fit)


def rms(values: Array) -> float:
    """Return the root mean square of values (n,)."""
    return float(np.sqrt(np.mean(values**2)))


def _equations(effect: Array, temperature: Array) -> tuple[Array, Array]:
    """Return columns (m, k) of a model of T, Ṫ and T·ΔT, and the effect (m,), as means; those after a gap are left out.

    A gap is where the temperature jumps; one at rest does no harm.
    """
    target, means = _means(effect), _means(temperature)
    steps = np.abs(np.diff(means, prepend=means[0]))
    after = np.convolve(steps > 1.5 * np.quantile(steps, 0.98), np.ones(BACK + 1))[: len(means)] > 0.0
    x, rate = (means - 25.0) / 35.0, np.gradient(means)
    change = means - np.r_[np.full(BACK, means[0]), means[:-BACK]]
    columns = [*(x**power for power in range(POWERS)), rate, rate * x, rate * x**2, change, change * x]
    return np.column_stack(columns)[~after], target[~after]


def _means(values: Array) -> Array:
    count = len(values) // MEAN
    return np.asarray(values[: count * MEAN].reshape(count, MEAN).mean(axis=1))
