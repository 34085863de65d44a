"""The cubic that stands for a drift, and what is said of its loss."""

import re
from dataclasses import replace

import numpy as np
import pytest
from builders import LINEAR, SCALING, make_calibration

from hgma_compensation.drift.model import CalibratedRange
from hgma_compensation.drift.polynomial import CUBIC, PolynomialDrift
from hgma_compensation.effects.applied import AppliedEffect
from hgma_compensation.effects.registry import make
from hgma_compensation.errors import RefusedError
from hgma_compensation.kalman.settings import FilterMode
from hgma_compensation.migration.cubic import fit_cubics, span_of
from hgma_compensation.migration.not_carried import not_carried
from hgma_compensation.migration.steady_drift import steady_drift
from hgma_compensation.temperature.features import Product


def with_drift(calibration, drift):
    """Return the calibration with another drift model in all channels."""
    return replace(calibration, channels=tuple(replace(c, drift=drift) for c in calibration.channels))


def test_it_is_the_fit_of_px4s_own_script_to_the_same_drift():
    # PX4/PX4-Autopilot Tools/process_sensor_caldata.py: polyfit of degree 3 to the temperature less its middle.
    calibration = make_calibration(3)
    span = span_of(calibration, None)
    temperature = span.grid()
    assert span.reference == 0.5 * (temperature.min() + temperature.max())
    drift = steady_drift(calibration, temperature, np.zeros(len(temperature)))
    for fitted, column in zip(fit_cubics(calibration, span), drift.T, strict=True):
        expected = np.polyfit(temperature - span.reference, column, 3)[::-1]
        np.testing.assert_allclose(fitted.cubic.coefficients, expected, rtol=1e-8, atol=1e-12 * np.abs(expected).max())


@pytest.mark.parametrize("reference", [None, 35.0])
def test_a_cubic_drift_is_exported_without_a_loss(reference):
    drift = PolynomialDrift(SCALING, CUBIC, np.array([0.3, -0.2, 0.15, 0.05]))
    calibration = with_drift(make_calibration(), drift)
    for fitted in fit_cubics(calibration, span_of(calibration, reference)):
        assert fitted.at_rest.worst < 1e-13
        assert fitted.over_rates.worst < 1e-13
        assert not_carried(calibration, LINEAR) == ()


def test_the_losses_are_those_of_the_full_model():
    calibration = make_calibration(5)
    span = span_of(calibration, None)
    fitted = fit_cubics(calibration, span)[1]
    for loss in (fitted.at_rest, fitted.over_rates):
        at = np.array([loss.temperature])
        full = steady_drift(calibration, at, np.array([loss.rate]))[0, 1]
        assert abs(fitted.cubic.evaluate(at)[0] - full) == pytest.approx(loss.worst, rel=1e-12)
        assert 0.0 < loss.rms <= loss.worst
    assert fitted.at_rest.rate == 0.0
    box = calibration.calibrated_range
    rates = np.linspace(box.lower[1], box.upper[1], 9)
    everywhere = [
        np.abs(steady_drift(calibration, span.grid(71), np.full(71, r))[:, 1] - fitted.cubic.evaluate(span.grid(71)))
        for r in rates
    ]
    assert np.max(everywhere) <= 1.05 * fitted.over_rates.worst
    step = 0.01
    slopes = np.diff(fitted.cubic.evaluate(np.arange(span.lowest, span.highest, step))) / step
    assert np.abs(slopes).max() == pytest.approx(fitted.steepest, rel=1e-2)


def test_a_part_of_the_range_loses_less():
    calibration = make_calibration(5)
    whole, part = span_of(calibration, None), span_of(calibration, None, (10.0, 30.0))
    assert (part.lowest, part.highest, part.reference) == (10.0, 30.0, 20.0)
    for all_of_it, some in zip(fit_cubics(calibration, whole), fit_cubics(calibration, part), strict=True):
        assert some.at_rest.rms < all_of_it.at_rest.rms
    assert span_of(calibration, 35.0, (-100.0, 20.0)).lowest == calibration.calibrated_range.lower[0]


@pytest.mark.parametrize(
    ("wanted", "words"),
    [
        ((20.0, 20.0), "is empty"),
        ((30.0, 20.0), "is empty"),
        ((float("nan"), 20.0), "is empty"),
        ((70.0, 90.0), "covers -11 to 61 °C only"),
        ((-90.0, -11.0), "covers -11 to 61 °C only"),
    ],
)
def test_temperatures_that_are_not_calibrated_are_refused(wanted, words):
    with pytest.raises(RefusedError, match=words):
        span_of(make_calibration(), None, wanted)


def test_what_is_left_out_is_named_with_its_channels():
    lag = make("thermal_lag", {"time_constant": 60.0, "lowest": -10.0, "highest": 60.0, "centres": 0.0, "spread": 1.0,
                               "poles": 1.0})  # fmt: skip
    effects = [AppliedEffect(channel, lag, np.ones(1)) for channel in LINEAR[1:]]
    lines = not_carried(make_calibration(mode=FilterMode.BIAS, effects=effects), LINEAR)
    axes = [f"linear_acceleration.{axis}" for axis in "xyz"]
    listed = [[re.sub(r" \(.*", "", name) for name in line.split(": ")[1].split(", ")] for line in lines]
    assert listed == [axes, axes[1:], axes]
    assert "rate" in lines[0]
    assert "thermal_lag" in lines[1]
    assert "Kalman" in lines[2]


def test_the_answer_to_the_rate_is_named_with_its_size():
    drift = PolynomialDrift(SCALING, np.array([[1, 0, 0], [0, 1, 0]]), np.array([1.0, 0.05]))
    lines = not_carried(with_drift(make_calibration(), drift), LINEAR[:1])
    # 0.05 m/s² at each 0.05 °C/s of the scaling, over rates of up to 1 °C/s.
    assert lines == ("answer of the drift to the temperature's rate: linear_acceleration.x (up to 1.00 m/s²)",)


def test_a_product_with_a_fixed_temperature_is_no_answer_to_the_rate():
    drift = PolynomialDrift(SCALING, np.array([[1, 0, 0], [0, 0, 1]]), np.array([1.0, 1.0]))
    reference = with_drift(make_calibration(product=Product.REFERENCE), drift)
    delay = with_drift(make_calibration(product=Product.DELAY), drift)
    assert not_carried(reference, LINEAR) == ()
    assert len(not_carried(delay, LINEAR)) == 1
    idle = with_drift(delay, replace(drift, coefficients=np.array([1.0, 0.0])))
    assert not_carried(idle, LINEAR) == ()


def test_a_range_without_rest_is_asked_at_its_slowest_rate():
    calibration = make_calibration()
    box = CalibratedRange(np.array([-11.0, 0.02, -2000.0]), np.array([61.0, 1.0, 2000.0]))
    ramped = replace(calibration, calibrated_range=box)
    at = np.linspace(-10.0, 60.0, 5)
    np.testing.assert_array_equal(
        steady_drift(ramped, at, np.zeros(5)),
        np.stack(
            [c.drift.evaluate(np.column_stack([at, np.full(5, 0.02), np.zeros(5)])) for c in ramped.channels], axis=1
        ),
    )
