"""The figures that a sensor is judged by, from its evaluation on data that it was not fitted to."""

from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.evaluation.evaluate import ChannelEvaluation

Array = NDArray[np.float64]


class Worse(str, Enum):
    """Which way a figure gets worse: up, down, or away from zero on either side."""

    UP = "up"
    DOWN = "down"
    AWAY = "away"


@dataclass(frozen=True)
class Figure:
    """title, short: for people. per: what its unit is the channel's over; None where it has no unit."""

    name: str
    title: str
    short: str
    worse: Worse
    per: str | None = ""

    def unit(self, channel_unit: str) -> str:
        """Return the figure's unit for a channel's."""
        return "" if self.per is None else channel_unit + self.per

    def digits(self, usual: int) -> int:
        """Return the significant digits to show of a figure: the usual ones, more of R², which differs in its last."""
        return 6 if self.per is None else usual

    def badness(self, value: float) -> float:
        """Return how bad a value is: 0 at best, in the figure's unit."""
        if self.worse is Worse.DOWN:
            return 1.0 - value
        return abs(value)


FIGURES = (
    Figure("raw_span", "raw span", "raw span", Worse.UP),
    Figure("raw_temperature_sensitivity", "raw temperature sensitivity", "raw slope", Worse.AWAY, "/°C"),
    Figure("velocity_random_walk", "noise (velocity random walk)", "noise", Worse.UP, "/√Hz"),
    Figure("bias_instability", "bias instability", "instability", Worse.UP),
    Figure("temperature_sensitivity", "temperature sensitivity left", "slope", Worse.AWAY, "/°C"),
    Figure("residual_mean", "residual mean", "mean", Worse.AWAY),
    Figure("residual_standard_deviation", "residual standard deviation", "deviation", Worse.UP),
    Figure("residual_peak_to_peak", "residual peak to peak", "span", Worse.UP),
    Figure("r_squared", "R²", "R²", Worse.DOWN, None),
)
BY_NAME = {figure.name: figure for figure in FIGURES}

SUMMARISED = (
    "velocity_random_walk",
    "temperature_sensitivity",
    "residual_mean",
    "residual_standard_deviation",
    "residual_peak_to_peak",
    "r_squared",
)
"""Names of the figures that stand beside each sensor, in terminal and page."""

Figures = dict[str, float | None]
"""By the names of FIGURES, in the channel's unit and what the figure adds to it; None where one is not defined."""


def figures_of(channel: ChannelEvaluation) -> Figures:
    """Return the figures of a channel, evaluated against the still value that its calibration keeps.

    Mean, deviation, span and sensitivities are those of means over 5 s. Both noise figures are those of the compensated
    output. R² = 1 − Σ residual² / Σ (raw − mean of raw)².
    """
    raw, residual = channel.raw_error, channel.compensated_error
    total = float(np.sum((raw - np.mean(raw)) ** 2))
    figures: Figures = {
        "raw_span": channel.raw.span,
        "raw_temperature_sensitivity": slope(channel.temperature, raw),
        "velocity_random_walk": channel.compensated.velocity_random_walk,
        "bias_instability": channel.compensated.bias_instability,
        "temperature_sensitivity": slope(channel.temperature, residual),
        "residual_mean": float(np.mean(residual)),
        "residual_standard_deviation": float(np.std(residual)),
        "residual_peak_to_peak": channel.compensated.span,
        "r_squared": 1.0 - float(np.sum(residual**2)) / total if total > 0.0 else None,
    }
    return {name: value if value is not None and np.isfinite(value) else None for name, value in figures.items()}


def slope(temperature: Array, values: Array) -> float | None:
    """Return the slope of the straight line through values (n,) over temperature (n,), °C, by least squares.

    None where the temperature does not change.
    """
    centred = temperature - np.mean(temperature)
    spread = float(np.sum(centred**2))
    return float(np.sum(centred * values)) / spread if spread > 0.0 else None
