"""Evidence for periodic interference: the line, and one period laid over the other."""

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.diagnosis.forward import Findings
from hgma_compensation.diagnosis.lines import power_spectrum
from hgma_compensation.effects.periodic_interference import PeriodicInterference
from hgma_compensation.report.pictures.canvas import Chart, cloud, instant, label, level, line, logarithmic, thinned
from hgma_compensation.report.pictures.evidence import Evidence
from hgma_compensation.report.words import duration, unit

Array = NDArray[np.float64]

MOST_LINES = 900


def spectrum(findings: Findings) -> list[Chart]:
    """Return the spectrum of the whitened residual with the drift model alone, and with all effects."""
    chart = Chart("Spectrum of what is left", "Whitened residual of the recordings; noise alone lies about 1.")
    states = [("before", "drift model alone", findings.before)]
    if findings.found:
        states.append(("after", "with the effects", findings.state))
    for colour, text, state in states:
        frequencies, power = power_spectrum(state.problem, state.projection.residual)
        if not len(frequencies):
            return []
        periods, highest = _envelope(1.0 / frequencies, power)
        line(chart.axes[0], periods, highest, colour, width=1.1)
        chart.key(colour, "line", text)
    for effect in findings.state.effects:
        if isinstance(effect, PeriodicInterference):
            instant(chart.axes[0], effect.period, "rival")
            chart.key("rival", "dash", f"line found, {duration(effect.period)}")
    logarithmic(chart.axes[0])
    label(chart.axes[0], "period, s", "power over that of noise")
    return [chart]


def _envelope(periods: Array, power: Array) -> tuple[Array, Array]:
    """Return the highest power in bins of ln(period), so that no line is lost."""
    edges = np.geomspace(periods.min(), periods.max() * 1.0001, MOST_LINES + 1)
    place = np.searchsorted(edges, periods, side="right") - 1
    highest = np.full(MOST_LINES, -np.inf)
    np.maximum.at(highest, np.clip(place, 0, MOST_LINES - 1), power)
    seen = np.isfinite(highest)
    return np.sqrt(edges[1:] * edges[:-1])[seen], np.maximum(highest[seen], 1e-3)


def folded(evidence: Evidence) -> list[Chart]:
    """Return what the line has to carry against its phase."""
    effect = evidence.effect
    if not isinstance(effect, PeriodicInterference):
        return []
    chart = Chart("One period laid over the other", f"Period {duration(effect.period)}.")
    cycles = (evidence.blocks.stamps - int(effect.origin)) * 1e-9 / effect.period
    phase = cycles - np.floor(cycles)
    axes, rows, order = chart.axes[0], thinned(len(phase)), np.argsort(phase)
    level(axes)
    cloud(axes, phase[rows], evidence.partial[rows], "after", alpha=0.6)
    line(axes, phase[order], evidence.contribution[order], "fit")
    chart.key("after", "dot", "partial residual")
    chart.key("fit", "line", "fitted effect")
    label(axes, "phase, periods", unit(evidence.channel))
    return [chart]
