"""Picture of an evaluation."""

import os
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from hgma_compensation.channels import unit_of
from hgma_compensation.errors import RefusedError
from hgma_compensation.evaluation.evaluate import ChannelEvaluation, Evaluation
from hgma_compensation.quantities import shown_unit

RAW, COMPENSATED = "#b5482a", "#1f6f8b"
"""Told apart by hue and by lightness, in print and by colour-blind readers."""


def plot_evaluation(evaluation: Evaluation, path: Path, title: str) -> None:
    """Draw each channel's error of 5 s means, before and after, and what is left of it on a scale of its own.

    The picture appears whole or not at all; raises RefusedError where it cannot be written.
    """
    rows = len(evaluation.channels)
    figure = Figure(figsize=(14.0, 1.2 + 2.6 * rows), layout="constrained")
    axes = figure.subplots(rows, 3, squeeze=False)
    figure.suptitle(title)
    for (left, middle, right), channel in zip(axes, evaluation.channels, strict=True):
        _against(left, channel.time / 60.0, channel, lines=True)
        _against(middle, channel.temperature, channel, lines=False)
        _left_over(right, channel)
        left.set_ylabel(f"{channel.name}\nerror, {shown_unit(unit_of(channel.name))}")
        left.legend(loc="best", fontsize="small")
    axes[-1][0].set_xlabel("time, min")
    axes[0][2].set_title("what is left", fontsize="medium")
    for column in (1, 2):
        axes[-1][column].set_xlabel("temperature, °C")
    scratch = path.with_name(f".{path.name}.part.png")
    try:
        figure.savefig(scratch, dpi=110)
        os.replace(scratch, path)
    except OSError as error:
        raise RefusedError(f"{path} cannot be written ({error.strerror}): choose another place") from None
    finally:
        scratch.unlink(missing_ok=True)


def _against(axes: Axes, x: NDArray[np.float64], channel: ChannelEvaluation, *, lines: bool) -> None:
    style = {"linewidth": 1.0} if lines else {"linestyle": "none", "marker": ".", "markersize": 2.5}
    axes.axhline(0.0, color="0.6", linewidth=0.8)
    axes.plot(x, channel.raw_error, color=RAW, label=f"raw, RMS {channel.raw.rms_error:.3g}", **style)
    axes.plot(
        x,
        channel.compensated_error,
        color=COMPENSATED,
        label=f"compensated, RMS {channel.compensated.rms_error:.3g}",
        **style,
    )
    axes.grid(color="0.9")


def _left_over(axes: Axes, channel: ChannelEvaluation) -> None:
    """Draw the compensated error alone, and the noise of a mean: a loop in it is memory of the temperature."""
    noise = 2.0 * channel.noise_floor
    axes.axhspan(-noise, noise, color="0.9", label="noise of a mean, 2σ")
    axes.plot(channel.temperature, channel.compensated_error, color=COMPENSATED, linewidth=0.8)
    axes.legend(loc="best", fontsize="small")
    axes.grid(color="0.9")
