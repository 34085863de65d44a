"""The drift at rest and on a ramp, against the pipeline that runs for long enough."""

import numpy as np
import pytest
from builders import EPOCH, LINEAR, make_calibration, make_stamps

from hgma_compensation.effects.applied import AppliedEffect
from hgma_compensation.effects.registry import kinds, make
from hgma_compensation.migration.steady_drift import steady_drift
from hgma_compensation.pipeline.pipeline import Pipeline
from hgma_compensation.temperature.features import Product

MAP = {"lowest": -10.0, "highest": 60.0, "centres": 0.0}
Z = "linear_acceleration.z"
SETTLES = {
    "thermal_lag": {"time_constant": 60.0, **MAP, "spread": 1.0, "poles": 1.0},
    "timing_offset": {"delay": 10.0, **MAP},
    "hysteresis": {"threshold": 2.0, "spread": 1.0, "bend": 0.0, "plays": 1.0, "before": 70.0, "offset": 1.0},
    "rate_dependent_hysteresis": {"exponent": 0.5, "rate_floor": 0.01},
    "stress_relaxation": {"time_constant": 500.0, "spread": 1.0},
    "warm_up": {"time_constant": 30.0, "spread": 1.0},
    "threshold_step": {"temperature": 20.0, "width": 5.0},
    "aging": {"onset": 100.0, "origin": float(EPOCH - 10**13), "limit": 500.0},
    "scale_factor_temperature": {"channel": Z},
    "quadratic_nonlinearity": {"channel": Z},
    "supply_voltage": {"nominal": 5.0},
    "thermal_gradient": {},
    "cross_axis": {"source": "linear_acceleration.y"},
    "post_shock_zero_shift": {"threshold": 5.0, "time_constant": 30.0, "channel": Z},
    "vibration_rectification": {"time_constant": 30.0, "floor": 0.0, "channel": Z},
}
"""One of each kind that has a drift at rest; a wave has none."""

AT_REST = np.zeros(1)


def pipeline_drift(calibration, start, rate, seconds=900.0):
    """Return the drift (c,) of the last sample, and its temperature, after a ramp (°C/s) from start °C."""
    time = np.arange(0.0, seconds)
    pipeline = Pipeline(calibration)
    for stamp, value in zip(make_stamps(time).tolist(), (start + rate * time).tolist(), strict=True):
        pipeline.add_temperature(stamp, value)
    stamps = make_stamps(time + 0.5)
    temperature = start + rate * (time + 0.5)
    # What a sensor at rest shows: its reference and the drift that the model knows, so that no input is left.
    model = steady_drift(make_calibration(), temperature, np.full(len(time), rate))
    wide = np.zeros((len(stamps), 6))
    wide[:, :3] = 9.81 + model
    return pipeline.compensate(stamps, wide[:, :3], wide).drift[-1], float(temperature[-1])


def test_each_kind_of_effect_is_looked_at():
    assert set(SETTLES) | {"periodic_interference"} == set(kinds())


@pytest.mark.parametrize("name", SETTLES)
@pytest.mark.parametrize("temperature", [-4.0, 51.0])
def test_effects_at_rest_are_those_of_a_sensor_that_has_stood_still_for_long(name, temperature):
    effect = make(name, SETTLES[name])
    calibration = make_calibration(effects=[AppliedEffect(Z, effect, np.full(effect.count, 0.3))])
    expected, _ = pipeline_drift(calibration, temperature, 0.0)
    drift = steady_drift(calibration, np.array([temperature]), AT_REST)[0]
    np.testing.assert_allclose(drift, expected, rtol=1e-6, atol=1e-6)


def test_a_step_in_temperature_is_part_of_the_drift_at_rest():
    step = make("threshold_step", SETTLES["threshold_step"])
    stepped = make_calibration(effects=[AppliedEffect(Z, step, np.array([2.0]))])
    at = np.array([0.0, 40.0]), np.zeros(2)
    change = (steady_drift(stepped, *at) - steady_drift(make_calibration(), *at))[:, 2]
    np.testing.assert_allclose(change, [0.0, 2.0], atol=1e-5)


def test_a_wave_leaves_the_drift_at_rest_alone():
    wave = kinds()["periodic_interference"](7.0, float(EPOCH))
    calibration = make_calibration(effects=[AppliedEffect(Z, wave, np.ones(wave.count))])
    at = np.linspace(-10.0, 60.0, 9), np.zeros(9)
    np.testing.assert_array_equal(steady_drift(calibration, *at), steady_drift(make_calibration(), *at))


@pytest.mark.parametrize("product", Product)
@pytest.mark.parametrize(("start", "rate"), [(-5.0, 0.05), (55.0, -0.04), (12.0, 0.0), (-11.0, -0.01)])
def test_on_a_ramp_it_is_the_pipelines_drift(product, start, rate):
    calibration = make_calibration(product=product, delay=20.0)
    expected, temperature = pipeline_drift(calibration, start, rate)
    drift = steady_drift(calibration, np.array([temperature]), np.array([rate]))[0]
    np.testing.assert_allclose(drift, expected, rtol=1e-4, atol=1e-4)
    assert len(drift) == len(LINEAR)
