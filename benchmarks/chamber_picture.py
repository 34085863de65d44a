"""Draws the chamber's error: before and after the diagnosis, and beside that of the raw readings."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from hgma_compensation.diagnosis.result import ChannelDiagnosis
from hgma_compensation.evaluation.plots import COMPENSATED, RAW

Array = NDArray[np.float64]

MILLI = 1e3
BARE = "0.45"


@dataclass(frozen=True)
class Raw:
    """temperature: (n,) °C. error: (n,) m/s² of means of the raw readings."""

    temperature: Array
    error: Array

    @property
    def rms(self) -> float:
        """RMS error, m/s²."""
        return float(np.sqrt(np.mean(self.error**2)))


def draw(channels: Sequence[ChannelDiagnosis], path: Path) -> None:
    """Draw the error of means of 5 s on the last cooling over temperature, mm/s²; the band is their noise."""
    figure = Figure(figsize=(12.0, 3.6), layout="constrained")
    axes = figure.subplots(1, len(channels), squeeze=False)[0]
    for axis, channel in zip(axes, channels, strict=True):
        before, after = channel.before, channel.after
        noise = 2.0 * MILLI * channel.noise_floor
        axis.axhspan(-noise, noise, color="0.88", label="noise of a mean, 2σ")
        axis.plot(before.temperature, MILLI * before.error, color=RAW, linewidth=1.0, label="network of T, Ṫ, T·ΔT")
        axis.plot(after.temperature, MILLI * after.error, color=COMPENSATED, linewidth=1.0, label="with its memories")
        axis.set_title(
            f"{channel.name[-1]}: RMS {MILLI * channel.error_before:.1f} → {MILLI * channel.error_after:.1f} mm/s²",
            fontsize="medium",
        )
        axis.set_xlabel("temperature, °C")
        axis.grid(color="0.93")
    axes[0].set_ylabel("error on the last cooling, mm/s²")
    axes[0].legend(loc="best", fontsize="small")
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=100)


def draw_before_after(raw: Sequence[Raw], channels: Sequence[ChannelDiagnosis], path: Path) -> None:
    """Draw what the raw readings are off by on the last cooling, and what is left, on two scales, mm/s²."""
    figure = Figure(figsize=(12.0, 5.2), layout="constrained")
    grid = figure.subplots(2, len(channels), sharex=True, squeeze=False)
    for (above, below), readings, channel in zip(grid.T, raw, channels, strict=True):
        above.plot(readings.temperature, MILLI * readings.error, color=BARE, linewidth=1.5, label="raw")
        for axis in (above, below):
            for held, colour, text in (
                (channel.before, RAW, "network on T, Ṫ, T·ΔT"),
                (channel.after, COMPENSATED, "with the effects found"),
            ):
                axis.plot(held.temperature, MILLI * held.error, color=colour, linewidth=1.0, label=text)
            axis.grid(color="0.93")
        noise = 2.0 * MILLI * channel.noise_floor
        below.axhspan(-noise, noise, color="0.88", label="noise of a mean, 2σ")
        figures = (MILLI * value for value in (readings.rms, channel.error_before, channel.error_after))
        above.set_title(f"{channel.name[-1]}: RMS " + " → ".join(f"{figure:.3g}" for figure in figures) + " mm/s²")
        below.set_xlabel("temperature, °C")
    grid[0, 0].set_ylabel("error, mm/s²")
    grid[1, 0].set_ylabel("the same, enlarged")
    grid[0, 0].legend(loc="best", fontsize="small")
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=90)
