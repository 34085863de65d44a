"""N and B of a still sensor where they are defined, and the deviation at fixed times where they are not.

A low-pass filter bends the Allan curve up to about ten of its time constants; what is read there is the
filter, not the sensor. So N (velocity random walk) after a filter is read only where τ >= 10 time constants
and the slope is -1/2, and B (bias instability) only from a flat part of the curve beyond them.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.evaluation.allan import FLICKER_FLOOR
from hgma_compensation.evaluation.allan_confidence import AllanTable, allan_table, dense_table

Array = NDArray[np.float64]

FIXED_TAUS = tuple(float(f"{m}e{e}") for e in range(-1, 5) for m in (1, 3))
"""s: the times at which deviations are compared before and after, 0.1 to 30 000 s."""

FILTER_TIMES = 10.0
"""Time constants of the filter below which the curve shows the filter; at ten N still reads 7 % low."""

WHITE_SLOPE, WHITE_TOLERANCE = -0.5, 0.1
FLAT_TOLERANCE = 0.2
DECADES = 0.5
"""A slope counts where the curve keeps it for so long: at long τ any slope comes about by chance."""

FEWEST_FREEDOM = 8.0
"""Equivalent degrees of freedom below which the curve is too uncertain (±25 %) to tell a flat part by."""


@dataclass(frozen=True)
class Figure:
    """A value with its 95 % interval and the τ (s) it was read at; without a value, the reason."""

    value: float | None
    lower: float | None = None
    upper: float | None = None
    tau: float | None = None
    reason: str = ""

    def __str__(self) -> str:
        """Return the value, or that it is not defined."""
        return "not defined" if self.value is None else f"{self.value:.4g}"


@dataclass(frozen=True)
class Stage:
    """The filter that a record has passed. time_constant: s. smooths: low-pass; else it takes a slow bias out."""

    time_constant: float
    smooths: bool = True

    @property
    def bandwidth(self) -> float | None:
        """Of a low-pass, Hz: 1/(2π τ)."""
        return float(1.0 / (2.0 * np.pi * self.time_constant)) if self.smooths else None


@dataclass(frozen=True)
class NoiseFigures:
    """Of one still record: deviations at FIXED_TAUS, N in unit/√Hz, B in the unit."""

    table: AllanTable
    velocity_random_walk: Figure
    bias_instability: Figure


def noise_figures(values: Array, interval: float, stage: Stage | None = None) -> NoiseFigures:
    """Return the figures of values (n,) of a still sensor, one every ``interval`` s, that have passed the stage."""
    dense = dense_table(values, interval)
    shortest = FILTER_TIMES * stage.time_constant if stage is not None else 0.0
    beyond = dense.select(dense.taus >= shortest * (1.0 - 1e-9))
    smoothed = stage is not None and stage.smooths
    return NoiseFigures(
        allan_table(values, interval, FIXED_TAUS),
        velocity_random_walk(beyond if smoothed else dense),
        bias_instability(beyond),
    )


def velocity_random_walk(curve: AllanTable) -> Figure:
    """Return N = σ(τ)√τ at the beginning of the longest part of slope -1/2 (IEEE Std 952, annex C)."""
    part = longest_part(curve, WHITE_SLOPE, WHITE_TOLERANCE)
    if part is None:
        return Figure(None, reason="no part of slope -1/2" if len(curve.taus) else "record too short for the filter")
    row = part.start
    root = float(np.sqrt(curve.taus[row]))
    value, lower, upper = (float(a[row]) * root for a in (curve.deviations, curve.lower, curve.upper))
    return Figure(value, lower, upper, float(curve.taus[row]))


def bias_instability(curve: AllanTable) -> Figure:
    """Return B = σ/0.664 over the longest flat part of the curve; the interval is that of its middle.

    What white noise there still is under a slope of at most FLAT_TOLERANCE makes it up to a quarter too large.
    """
    part = longest_part(curve, 0.0, FLAT_TOLERANCE)
    if part is None:
        return Figure(None, reason="no flat part" if len(curve.taus) else "record too short for the filter")
    middle = (part.start + part.stop) // 2
    level = float(np.exp(np.log(curve.deviations[part]).mean()) / FLICKER_FLOOR)
    scale = level / float(curve.deviations[middle])
    lower, upper = float(curve.lower[middle]) * scale, float(curve.upper[middle]) * scale
    return Figure(level, lower, upper, float(curve.taus[middle]))


def longest_part(curve: AllanTable, slope: float, tolerance: float) -> slice | None:
    """Return the rows of the longest part of a slope, None where none reaches DECADES."""
    flags = (np.abs(curve.slopes - slope) <= tolerance) & (curve.freedom >= FEWEST_FREEDOM)
    start, stop = longest_run(flags)
    if stop - start < 2 or np.log10(curve.taus[stop - 1] / curve.taus[start]) < DECADES * 0.999:
        return None
    return slice(start, stop)


def longest_run(flags: NDArray[np.bool_]) -> tuple[int, int]:
    """Return start and stop of the longest run of true, (0, 0) where there is none."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(int)))
    starts, stops = edges[::2], edges[1::2]
    if not len(starts):
        return 0, 0
    longest = int(np.argmax(stops - starts))
    return int(starts[longest]), int(stops[longest])
