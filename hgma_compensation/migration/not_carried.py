"""What of a calibration a cubic in temperature cannot carry, in words."""

from collections.abc import Sequence

import numpy as np

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.channels import unit_of
from hgma_compensation.drift.inputs import Array
from hgma_compensation.kalman.settings import FilterMode
from hgma_compensation.migration.steady_drift import steady_drift
from hgma_compensation.quantities import quantity

FILTERS = {
    FilterMode.SMOOTH: "Kalman stage that smooths",
    FilterMode.BIAS: "Kalman stage that follows the bias at rest",
}

NEGLIGIBLE = 0.01
"""Share of a model's own error below which its answer to the rate is not worth a word."""

POINTS = 41
"""Temperatures, and rates, at which that answer is looked for."""


def not_carried(calibration: Calibration, channels: Sequence[str]) -> tuple[str, ...]:
    """Return what an autopilot leaves out of these channels, with their names; what is static in it is in the cubic."""
    found: dict[str, list[str]] = {}
    exported = [channel for channel in calibration.channels if channel.name in channels]
    answers = dict(zip(calibration.names, _answers_to_rate(calibration).tolist(), strict=True))
    for channel in exported:
        if answers[channel.name] > NEGLIGIBLE * channel.error.unseen:
            size = f"{channel.name} (up to {quantity(answers[channel.name], unit_of(channel.name), 3)})"
            found.setdefault("answer of the drift to the temperature's rate", []).append(size)
    for applied in calibration.effects:
        if applied.channel in channels:
            found.setdefault(f"{applied.effect.title} (effect {applied.effect.name})", []).append(applied.channel)
    for channel in exported:
        if channel.filter.mode is not FilterMode.OFF:
            found.setdefault(FILTERS[channel.filter.mode], []).append(channel.name)
    return tuple(f"{what}: {', '.join(dict.fromkeys(names))}" for what, names in found.items())


def _answers_to_rate(calibration: Calibration) -> Array:
    """Return the largest change (c,) that a rate of the calibrated range makes to the drift at rest."""
    box = calibration.calibrated_range
    axes = (np.linspace(box.lower[number], box.upper[number], POINTS) for number in (0, 1))
    temperature, rate = (np.ravel(axis) for axis in np.meshgrid(*axes))
    change = steady_drift(calibration, temperature, rate) - steady_drift(calibration, temperature, np.zeros(len(rate)))
    return np.asarray(np.abs(change).max(axis=0))
