"""Draws the chamber's error before and after the diagnosis."""

from collections.abc import Sequence
from pathlib import Path

from matplotlib.figure import Figure

from hgma_compensation.diagnosis.result import ChannelDiagnosis
from hgma_compensation.evaluation.plots import COMPENSATED, RAW

MILLI = 1e3


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
