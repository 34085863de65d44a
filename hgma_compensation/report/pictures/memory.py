"""Evidence for effects that remember the temperature: loops, corners, soaks."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.quantities import counted
from hgma_compensation.report.pictures.aligned import Aligned, align, corners, soaks
from hgma_compensation.report.pictures.canvas import Chart, cloud, instant, label, level, line, thinned
from hgma_compensation.report.pictures.evidence import Evidence
from hgma_compensation.report.pictures.ramps import DIRECTIONS, name_directions
from hgma_compensation.report.words import number, plain_name, unit

Array = NDArray[np.float64]

BINS = 14
CLASSES = (("cool", "slow ramps"), ("heat", "fast ramps"))


def loop(evidence: Evidence) -> list[Chart]:
    """Return the loop over temperature, and its width."""
    chart = Chart(
        "The loop over temperature",
        "What the effect has to carry, less what a drift model over temperature could: the same temperature gives "
        "another value on the way up than on the way down.",
    )
    name_directions(chart)
    chart.key("fit", "dot", "fitted effect")
    axes, rows = chart.axes[0], thinned(len(evidence.partial))
    level(axes)
    for colour, _, sign in DIRECTIONS:
        mine = rows[evidence.direction[rows] == sign]
        cloud(axes, evidence.temperature[mine], (evidence.partial - evidence.static)[mine], colour)
    cloud(axes, evidence.temperature[rows], (evidence.contribution - evidence.static)[rows], "fit", size=1.0, alpha=0.9)
    label(axes, "temperature, °C", f"partial residual, {unit(evidence.channel)}")
    return [chart, *width_of_loop(evidence)]


def width_of_loop(evidence: Evidence) -> list[Chart]:
    """Return the mean of heating less that of cooling over temperature, for slow and fast ramps."""
    moving = np.abs(evidence.rate[evidence.direction != 0])
    if len(moving) < 4 * BINS:
        return []
    middle = 0.5 * float(np.quantile(moving, 0.1) + np.quantile(moving, 0.9))
    several = float(np.quantile(moving, 0.9)) > 1.4 * float(np.quantile(moving, 0.1))
    text = "Heating less cooling. A width that grows with the rate points to a lag, an equal one to hysteresis."
    chart = Chart("Width of the loop", text if several else "Heating less cooling.")
    edges = np.linspace(evidence.temperature.min(), evidence.temperature.max(), BINS + 1)
    axes, at = chart.axes[0], 0.5 * (edges[1:] + edges[:-1])
    level(axes)
    for fast, (colour, name) in enumerate(CLASSES):
        mine = (np.abs(evidence.rate) > middle) == bool(fast) if several else np.full(len(evidence.rate), fast == 1)
        if not mine.any():
            continue
        cloud(axes, at, _width(evidence, evidence.partial - evidence.static, mine, edges), colour, size=5.0, alpha=1.0)
        line(axes, at, _width(evidence, evidence.contribution - evidence.static, mine, edges), colour)
        speed = 60.0 * float(np.median(np.abs(evidence.rate[mine & (evidence.direction != 0)])))
        chart.key(colour, "dot", f"{name if several else 'ramps'}, {number(speed, 2)} °C/min (line: fitted)")
    label(axes, "temperature, °C", f"width, {unit(evidence.channel)}")
    return [chart]


def _width(evidence: Evidence, values: Array, mine: NDArray[np.bool_], edges: Array) -> Array:
    means = []
    for sign in (1, -1):
        rows = mine & (evidence.direction == sign)
        place = np.clip(np.searchsorted(edges, evidence.temperature[rows], side="right") - 1, 0, len(edges) - 2)
        count = np.bincount(place, minlength=len(edges) - 1)
        total = np.bincount(place, values[rows], minlength=len(edges) - 1)
        means.append(np.where(count >= 3, total / np.maximum(count, 1), np.nan))
    return np.asarray(means[0] - means[1])


def corner_response(evidence: Evidence) -> list[Chart]:
    """Return the mean response to the corners of the temperature, with that of the best rival."""
    after = float(np.clip(6.0 * _time_of(evidence), 300.0, 1500.0))
    aligned = align(evidence, corners(evidence), 240.0, after)
    if aligned is None:
        return []
    chart = Chart(
        "Response to the corners of the temperature",
        f"Mean of {counted(len(aligned.weights), 'corner')} between ramps and soaks, 1 where the effect has settled. "
        "A lag bends off at once and settles exponentially; a delay runs straight and stops.",
    )
    edges = np.arange(-240.0, after, max(20.0, 1.5 * evidence.state.problem.block))
    return [_aligned_chart(chart, evidence, aligned, edges, "s after the corner", ("thermal_lag", "timing_offset"))]


def soak_response(evidence: Evidence) -> list[Chart]:
    """Return the mean decay in soaks."""
    starts, longest = soaks(evidence, 480.0)
    if not len(starts):
        return []
    aligned = align(evidence, starts, 0.0, longest, rest_at_end=True)
    if aligned is None:
        return []
    chart = Chart(
        "Decay in soaks",
        f"Mean of {counted(len(aligned.weights), 'soak')} at one temperature. Creep goes on; hysteresis stands still.",
    )
    edges = np.arange(0.0, longest, max(60.0, longest / 30.0))
    return [_aligned_chart(chart, evidence, aligned, edges, "min into the soak", evidence.effect.confused_with)]


def _aligned_chart(
    chart: Chart, evidence: Evidence, aligned: Aligned, edges: Array, name: str, rivals: Sequence[str]
) -> Chart:
    axes, at = chart.axes[0], 0.5 * (edges[1:] + edges[:-1]) / (60.0 if name.startswith("min") else 1.0)
    level(axes)
    if edges[0] < 0.0:
        instant(axes, 0.0)
    cloud(axes, at, aligned.mean(evidence.partial - evidence.static, edges), "after", size=5.0, alpha=1.0)
    line(axes, at, aligned.mean(evidence.contribution - evidence.static, edges), "fit")
    chart.key("after", "dot", "data")
    chart.key("fit", "line", f"fitted {plain_name(evidence.effect.name)}")
    rival = evidence.rival(rivals)
    if rival is not None:
        line(axes, at, aligned.mean(rival[1] - evidence.static, edges), "rival", "--")
        chart.key("rival", "dash", f"best {plain_name(rival[0])} in its place")
    label(axes, name, "share of the response")
    return chart


def _time_of(evidence: Evidence) -> float:
    parameters = evidence.effect.parameters()
    return float(parameters.get("time_constant", parameters.get("delay", 60.0)))
