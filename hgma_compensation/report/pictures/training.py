"""What a training has learned: drift over temperature, what rate adds, what is left, how the search went."""

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.report.pictures.canvas import Chart, cloud, label, level, line, logarithmic
from hgma_compensation.report.pictures.decimate import extremes
from hgma_compensation.report.pictures.drift import steady_ramp
from hgma_compensation.report.pictures.ramps import DIRECTIONS, direction, name_directions, still_rate
from hgma_compensation.report.pictures.svg import COLOURS
from hgma_compensation.report.training_result import TrainedChannel
from hgma_compensation.report.words import number, unit
from hgma_compensation.training.folds import Folds
from hgma_compensation.training.methods import Method

Array = NDArray[np.float64]

METHODS = {
    Method.POLYNOMIAL: ("before", "cubic in temperature"),
    Method.POLYNOMIAL_RATE: ("cool", "cubic with rate terms"),
    Method.RBF: ("rival", "network by gradient descent"),
    Method.RBF_GA: ("after", "network by genetic search"),
}
"""Colour and name of each."""


def ramp_rates(rate: Array) -> list[tuple[str, float]]:
    """Return colour and rate in °C/s of the ramps to draw: as the recordings cooled, held and heated, in the median."""
    still = still_rate(rate)
    cooling, heating = rate[rate < -still], rate[rate > still]
    ramps = [("cool", cooling), ("soak", np.zeros(1)), ("heat", heating)]
    return [(colour, float(np.median(own))) for colour, own in ramps if len(own)]


def learned_charts(calibration: Calibration, channel: TrainedChannel, most: int) -> list[Chart]:
    """Return the drift model among the means it was fitted to, what rate adds to it, and what the fit leaves."""
    drift = Chart("Drift over temperature", "Lines: the model on steady ramps. Dots: the means it was fitted to.")
    added = Chart(
        "What the rate adds", "The same less the model at a steady temperature: apart by direction is what rate does."
    )
    rows = extremes(channel.target, most)
    temperature = channel.features[:, 0]
    way = direction(channel.features[:, 1])[rows]
    at, steady = steady_ramp(calibration, channel.name, 0.0)
    beyond = channel.target - np.interp(temperature, at, steady)
    for colour, _, sign in DIRECTIONS:
        mine = rows[way == sign]
        cloud(drift.axes[0], temperature[mine], channel.target[mine], colour, alpha=0.45)
        cloud(added.axes[0], temperature[mine], beyond[mine], colour, alpha=0.45)
    for colour, rate in ramp_rates(channel.features[:, 1]):
        _, curve = steady_ramp(calibration, channel.name, rate)
        for chart, values in ((drift, curve), (added, curve - steady)):
            line(chart.axes[0], at, values, colour, width=2.0)
            chart.key(colour, "line", f"{number(60.0 * rate, 2)} °C/min")
    label(drift.axes[0], "temperature, °C", f"drift, {unit(channel.name)}")
    label(added.axes[0], "temperature, °C", unit(channel.name))
    return [drift, added, *(_left(channel, variable, most) for variable in ("temperature", "rate"))]


def _left(channel: TrainedChannel, variable: str, most: int) -> Chart:
    chart = Chart(f"What the fit leaves, against {variable}", "The band is the noise of such a mean, ±2σ.")
    name_directions(chart)
    chart.key("band", "area", "noise")
    axes, noise, residual = chart.axes[0], 2.0 * channel.calibration.error.noise, channel.residual
    axes.axhspan(-noise, noise, color=COLOURS["band"], linewidth=0.0, alpha=0.18)
    level(axes)
    rows = extremes(residual, most)
    x = channel.features[:, 0] if variable == "temperature" else 60.0 * channel.features[:, 1]
    way = direction(channel.features[:, 1])[rows]
    for colour, _, sign in DIRECTIONS:
        cloud(axes, x[rows][way == sign], residual[rows][way == sign], colour)
    label(axes, "temperature, °C" if variable == "temperature" else "temperature rate, °C/min", unit(channel.name))
    return chart


def comparison_chart(channel: TrainedChannel, folds: Folds) -> Chart:
    """Return the error of every method on every fold left out, against the noise."""
    chart = Chart(
        "Error on what was left out",
        "RMS on each fold, by a fit that has not seen it. Line: all folds together. Dashed: the noise of the means.",
        height=3.0,
    )
    axes = chart.axes[0]
    for row, result in enumerate(channel.results):
        colour, name = METHODS[result.method]
        errors = np.array(result.of_folds(folds))
        spread = np.linspace(-0.18, 0.18, len(errors)) if len(errors) > 1 else np.zeros(1)
        cloud(axes, row + spread, errors, colour, size=6.0, alpha=0.9)
        line(axes, np.array([row - 0.32, row + 0.32]), np.full(2, result.cross_validated), colour, width=2.2)
        chart.key(colour, "dot", name)
    if channel.calibration.error.noise > 0.0:
        line(
            axes,
            np.array([-0.5, len(channel.results) - 0.5]),
            np.full(2, channel.calibration.error.noise),
            "soak",
            "--",
            1.3,
        )
        chart.key("soak", "dash", "noise of the means")
    axes.set_xlim(-0.5, len(channel.results) - 0.5)
    logarithmic(axes, ("y",))
    axes.set_xticks(range(len(channel.results)), ["cubic", "cubic, rate", "RBF", "RBF-GA"])
    axes.grid(visible=False, axis="x")
    label(axes, y=f"RMS error, {unit(channel.name)}")
    return chart


def search_chart(channel: TrainedChannel, generations: int) -> list[Chart]:
    """Return the best error after each generation; generations: the longest that one search may take."""
    # The search for the likeliest network goes by another error.
    errors = channel.search[: 2 * generations]
    if len(errors) < 2:
        return []
    chart = Chart(
        "How the search went",
        "Best error on left-out folds after each generation. First networks that answer to the rate in proportion, "
        "then networks that may bend in it.",
        height=3.0,
    )
    axes = chart.axes[0]
    at = np.arange(1, len(errors) + 1, dtype=np.float64)
    for colour, name, rows in (
        ("before", "straight in the rate", slice(0, generations)),
        ("after", "may bend in the rate", slice(generations - 1, None)),
    ):
        if len(at[rows]) > 1:
            line(axes, at[rows], errors[rows], colour, width=2.0)
            chart.key(colour, "line", name)
    noise = channel.calibration.error.noise
    if noise > 0.0:
        line(axes, at[[0, -1]], np.full(2, noise), "soak", "--", 1.3)
        chart.key("soak", "dash", "noise of the means")
    logarithmic(axes, ("y",))
    label(axes, "generation", f"best error, {unit(channel.name)}")
    return [chart]
