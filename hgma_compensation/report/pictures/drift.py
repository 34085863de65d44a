"""The drift model over temperature at some rates, as it was and as it is."""

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.report.pictures.canvas import Chart, label, level, line
from hgma_compensation.report.words import number, unit
from hgma_compensation.temperature.features import Product

Array = NDArray[np.float64]

RATES = (("cool", -1.0), ("soak", 0.0), ("heat", 1.0))
POINTS = 150


def drift_charts(old: Calibration | None, new: Calibration, channel: str) -> list[Chart]:
    """Return the drift model of a channel on steady ramps; the old one where it is known, and what has changed."""
    fastest = 0.6 * min(-float(new.calibrated_range.lower[1]), float(new.calibrated_range.upper[1]))
    rates = [(colour, sign * fastest) for colour, sign in RATES if sign == 0.0 or fastest > 0.0]
    chart = Chart("Drift model over temperature", "On steady ramps, without the effects.")
    charts = [chart]
    for colour, rate in rates:
        at, drift = steady_ramp(new, channel, rate)
        line(chart.axes[0], at, drift, colour)
        chart.key(colour, "line", f"{number(60.0 * rate, 2)} °C/min")
        if old is not None:
            line(chart.axes[0], at, steady_ramp(old, channel, rate)[1], colour, ":", 1.2)
    if old is not None:
        chart.caption += " Dotted: as it was."
        change = Chart("Change of the drift model", "New less old: what the effects have taken over from it.")
        level(change.axes[0])
        for colour, rate in rates:
            at, drift = steady_ramp(new, channel, rate)
            line(change.axes[0], at, drift - steady_ramp(old, channel, rate)[1], colour)
            change.key(colour, "line", f"{number(60.0 * rate, 2)} °C/min")
        charts.append(change)
    for one in charts:
        label(one.axes[0], "temperature, °C", unit(channel))
    return charts


def steady_ramp(calibration: Calibration, channel: str, rate: float) -> tuple[Array, Array]:
    """Return temperatures (k,) in °C and the drift model (k,) at them on a steady ramp of a rate in °C/s."""
    settings, box = calibration.features, calibration.calibrated_range
    temperature = np.linspace(float(box.lower[0]), float(box.upper[0]), POINTS)
    if settings.product is Product.DELAY:
        difference = np.full(POINTS, rate * settings.delay)
    else:
        difference = temperature - settings.reference_temperature
    features = box.clamp(np.column_stack([temperature, np.full(POINTS, rate), temperature * difference]))
    model = next(c for c in calibration.channels if c.name == channel)
    return temperature, model.drift.evaluate(features)
