"""What a calibration takes the drift to be where the temperature stands still, or goes evenly."""

import numpy as np

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.channels import CHANNELS
from hgma_compensation.drift.inputs import Array
from hgma_compensation.drift.model import CalibratedRange
from hgma_compensation.effects.applied import AppliedEffect
from hgma_compensation.effects.conditions import Conditions
from hgma_compensation.effects.effect import Effect, no_memory
from hgma_compensation.effects.memory import Coldness
from hgma_compensation.effects.periodic_interference import PeriodicInterference
from hgma_compensation.stamps import NANOSECONDS
from hgma_compensation.temperature.features import FeatureSettings, Product

FOR_EVER = 1e7
"""s since the power-on: every warm-up is over."""


def features_at(temperature: Array, rate: Array, settings: FeatureSettings, box: CalibratedRange) -> Array:
    """Return the features (n, 3) of a steady ramp, moved into the calibrated range as the pipeline does it.

    temperature: (n,) °C. rate: (n,) °C/s, 0 for a temperature that stands still.
    """
    if settings.product is Product.DELAY:
        difference = rate * settings.delay
    else:
        difference = temperature - settings.reference_temperature
    return box.clamp(np.column_stack([temperature, rate, temperature * difference]))


def steady_drift(calibration: Calibration, temperature: Array, rate: Array) -> Array:
    """Return the drift (n, c) in each channel's unit at temperatures (n,) °C and rates (n,) °C/s.

    Drift models are asked on a steady ramp. Effects add what they make of a sensor at rest that has been on, and at the
    temperature, for ever; second thermometer and supply voltage unknown; at the end of the last training recording.
    """
    inside = features_at(temperature, rate, calibration.features, calibration.calibrated_range)
    drift = np.stack([channel.drift.evaluate(inside) for channel in calibration.channels], axis=1)
    at = _at_rest(calibration, inside[:, 0])
    for applied in calibration.effects:
        drift[:, calibration.names.index(applied.channel)] += _settled(applied, at)
    return drift


def _at_rest(calibration: Calibration, temperature: Array) -> Conditions:
    last = max(r["start"] + int(r["duration"] * NANOSECONDS) for r in calibration.training["recordings"])
    count, unknown = len(temperature), np.full(len(temperature), np.nan)
    return Conditions(
        stamps=np.full(count, last, dtype=np.int64),
        since_power_on=np.full(count, FOR_EVER),
        temperature=temperature,
        rate=np.zeros(count),
        earlier=lambda _: temperature,
        temperature_2=unknown,
        supply_voltage=unknown,
        acceleration=np.zeros((count, len(CHANNELS))),
    )


def _settled(applied: AppliedEffect, at: Conditions) -> Array:
    """Return what the effect makes (n,) of each row's own temperature once it has lasted for ever."""
    effect = applied.effect
    if isinstance(effect, PeriodicInterference) or effect.acceleration_memory() is not None:
        return np.zeros(len(at))  # a wave has no part that stays, and what remembers shocks or vibration has had none
    return np.nan_to_num(applied.drift(at, _state(effect, at)), nan=0.0)


def _state(effect: Effect, at: Conditions) -> Array:
    memory = effect.memory()
    if memory is None:
        return no_memory(len(at))
    if isinstance(memory, Coldness):  # which starts at the power-on, and not in equilibrium as the others
        return np.zeros((len(at), memory.size))
    return np.stack([memory.start(np.array([value])) for value in at.temperature])
