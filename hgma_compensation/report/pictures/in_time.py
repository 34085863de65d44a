"""Evidence for effects of time and events: power-on, age, shocks, lines; and the picture that serves all."""

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.quantities import counted
from hgma_compensation.report.pictures.aligned import align
from hgma_compensation.report.pictures.canvas import Chart, cloud, instant, label, level, line, thinned
from hgma_compensation.report.pictures.evidence import Evidence
from hgma_compensation.report.words import unit

Array = NDArray[np.float64]

COLOURS_OF_RUNS = ("cool", "heat", "rival", "after", "before", "soak")


def over_recordings(evidence: Evidence) -> list[Chart]:
    """Return what an effect has to carry and what it carries against time."""
    chart = Chart("Over the recordings", "What the effect has to carry, and what is fitted; pauses are cut out.")
    _points_and_fit(chart, evidence, evidence.recorded_hours)
    for rows in evidence.runs[1:]:
        instant(chart.axes[0], float(evidence.recorded_hours[rows[0]]))
    label(chart.axes[0], "recorded time, h")
    return [chart]


def after_power_on(evidence: Evidence) -> list[Chart]:
    """Return it against the time since power came on, one line for each power-on."""
    since = evidence.since_power_on / 60.0
    starts = np.round(evidence.seconds / 60.0 - since)
    count = len(np.unique(starts))
    chart = Chart(
        "After power-on", f"{counted(count, 'power-on')} in {counted(len(evidence.runs), 'recording')}, in colours."
    )
    axes = chart.axes[0]
    level(axes)
    for number, start in enumerate(np.unique(starts)):
        rows = np.flatnonzero(starts == start)
        rows = rows[thinned(len(rows), 600)]
        colour = COLOURS_OF_RUNS[number % len(COLOURS_OF_RUNS)]
        cloud(axes, since[rows], evidence.partial[rows], colour)
        line(axes, since[rows], evidence.contribution[rows], "fit", width=1.2)
    chart.key("fit", "line", "fitted effect")
    label(axes, "time since power-on, min", f"partial residual, {unit(evidence.channel)}")
    return [chart]


def over_age(evidence: Evidence) -> list[Chart]:
    """Return the level at any one temperature against real time."""
    chart = Chart(
        "Level against time, temperature taken out",
        "The drift with temperature is subtracted: without aging every recording would lie at one level.",
    )
    _points_and_fit(chart, evidence, evidence.seconds / 3600.0)
    label(chart.axes[0], "time from the first sample, h")
    return [chart]


def after_shocks(evidence: Evidence) -> list[Chart]:
    """Return it against time, with the shocks."""
    chart = Chart("Before and after the shocks", "Dashed: shocks. A zero shift steps at them and stays, or decays.")
    _points_and_fit(chart, evidence, evidence.recorded_hours)
    steps = np.abs(np.diff(evidence.columns[:, 0], prepend=evidence.columns[:1, 0]))
    steps[np.diff(evidence.blocks.run, prepend=evidence.blocks.run[:1]) != 0] = 0.0
    shocks = np.flatnonzero(steps > 0.05 * steps.max(initial=0.0))
    shocks = shocks[np.diff(shocks, prepend=-2) > 1]  # the mean over a block holds a part of the step
    for row in shocks:
        instant(chart.axes[0], float(evidence.recorded_hours[row]), "rival")
    chart.key("rival", "dash", "shock")
    label(chart.axes[0], "recorded time, h (pauses cut out)")
    return [chart, *_mean_shock(evidence, shocks)]


def _mean_shock(evidence: Evidence, shocks: NDArray[np.int64]) -> list[Chart]:
    """Return the mean of what follows a shock."""
    after = float(np.clip(4.0 * evidence.effect.parameters()["time_constant"], 300.0, 3600.0))
    aligned = align(evidence, shocks, 240.0, after, memory=False)
    if aligned is None:
        return []
    chart = Chart(
        "What a shock leaves", f"Mean of {counted(len(aligned.weights), 'shock')}, 1 at the end of the window."
    )
    edges = np.arange(-240.0, after, max(30.0, after / 50.0))
    at = 0.5 * (edges[1:] + edges[:-1]) / 60.0
    level(chart.axes[0])
    instant(chart.axes[0], 0.0, "rival")
    cloud(chart.axes[0], at, aligned.mean(evidence.partial, edges), "after", size=5.0, alpha=1.0)
    line(chart.axes[0], at, aligned.mean(evidence.contribution, edges), "fit")
    chart.key("after", "dot", "data")
    chart.key("fit", "line", "fitted effect")
    label(chart.axes[0], "min after the shock", "share of the shift")
    return [chart]


def _points_and_fit(chart: Chart, evidence: Evidence, hours: Array) -> None:
    axes = chart.axes[0]
    level(axes)
    for rows in evidence.runs:
        rows = rows[thinned(len(rows), 1000)]
        cloud(axes, hours[rows], evidence.partial[rows], "after", alpha=0.6)
        line(axes, hours[rows], evidence.contribution[rows], "fit", width=1.2)
    chart.key("after", "dot", "partial residual")
    chart.key("fit", "line", "fitted effect")
    label(axes, y=unit(evidence.channel))
