"""Columns of effects against closed forms."""

import numpy as np
import pytest
from numpy.typing import NDArray
from test_effects_examples import EPOCH, columns, conditions

from hgma_compensation.channels import CHANNELS
from hgma_compensation.effects.aging import Aging
from hgma_compensation.effects.conditions import Conditions
from hgma_compensation.effects.cross_axis import CrossAxis
from hgma_compensation.effects.hysteresis import Hysteresis
from hgma_compensation.effects.periodic_interference import PeriodicInterference
from hgma_compensation.effects.quadratic_nonlinearity import QuadraticNonlinearity
from hgma_compensation.effects.rate_dependent_hysteresis import RateDependentHysteresis
from hgma_compensation.effects.scale_factor_temperature import ScaleFactorTemperature
from hgma_compensation.effects.static_map import FINE, map_difference
from hgma_compensation.effects.stress_relaxation import StressRelaxation
from hgma_compensation.effects.supply_voltage import SupplyVoltage
from hgma_compensation.effects.thermal_gradient import ThermalGradient
from hgma_compensation.effects.thermal_lag import ThermalLag
from hgma_compensation.effects.threshold_step import ThresholdStep
from hgma_compensation.effects.timing_offset import TimingOffset
from hgma_compensation.effects.warm_up import WarmUp

Array = NDArray[np.float64]
SECONDS = np.arange(0.0, 3000.0)
RATE = 1.0 / 60.0


def ramp(time: Array) -> Array:
    return np.asarray(10.0 + RATE * time)


def step(time: Array) -> Array:
    """10 °C up between the samples at 0 and at 1 s: a ramp of one second."""
    return np.asarray(np.where(time > 0.0, 30.0, 20.0))


def ramped_up(time_constant: Array | float) -> Array:
    """What a low-pass is behind at the end of that ramp, °C."""
    return np.asarray(10.0 * time_constant * -np.expm1(-1.0 / time_constant))


def steady(time: Array) -> Array:
    return np.asarray(60.0 + 0.0 * time)


def at_rest(**inputs: Array) -> Conditions:
    return conditions(np.arange(3.0), steady, **inputs)


def test_lag_behind_a_ramp_is_the_rate_times_the_time_constant() -> None:
    lag = columns(ThermalLag(100.0, -10.0, 60.0, 0.0), conditions(SECONDS, ramp))[:, 0]
    np.testing.assert_allclose(lag, -RATE * 100.0 * (1.0 - np.exp(-SECONDS / 100.0)), atol=1e-10)


def test_two_poles_of_a_linear_map_make_a_cascade() -> None:
    fast, slow = 40.0, 160.0
    lag = ThermalLag(80.0, -10.0, 60.0, 0.0, 4.0, 2.0)
    assert lag.memory().time_constants == pytest.approx((fast, slow), rel=1e-15)
    since = SECONDS[1:] - 1.0
    decay = ramped_up(fast) * np.exp(-since / fast), ramped_up(slow) * np.exp(-since / slow)
    cascade = (fast * decay[0] - slow * decay[1]) / (slow - fast)
    gains = np.array([-fast, slow]) / (slow - fast)
    np.testing.assert_allclose((columns(lag, conditions(SECONDS, step)) @ gains)[1:], cascade, atol=1e-9)


def test_offset_of_a_ramp_is_the_rate_times_the_delay() -> None:
    offset = TimingOffset(12.0, -10.0, 60.0, 0.0)
    np.testing.assert_allclose(columns(offset, conditions(SECONDS, ramp)), -RATE * 12.0)
    assert offset.history == 12.0


def test_fine_map_follows_a_quintic() -> None:
    temperature = np.linspace(-10.0, 60.0, 300)
    reference = np.full_like(temperature, 25.0)
    basis = map_difference(temperature, reference, -10.0, 60.0, FINE)
    map_ = ((temperature - 25.0) / 35.0) ** 5
    basis = np.column_stack([basis, np.ones_like(temperature)])
    gains = np.linalg.lstsq(basis, map_, rcond=None)[0]
    assert np.abs(basis @ gains - map_).max() < 0.005 * np.ptp(map_)


def test_stress_of_a_step_relaxes_as_a_prony_series() -> None:
    relaxing = columns(StressRelaxation(900.0, 3.0), conditions(SECONDS, step))
    poles = np.array([300.0, 900.0, 2700.0])
    expected = ramped_up(poles) * np.exp(-(SECONDS[1:, None] - 1.0) / poles)
    np.testing.assert_allclose(relaxing[1:], expected, rtol=1e-9)


def test_play_trails_by_its_threshold_and_turns_after_twice_that() -> None:
    at = conditions(np.arange(0.0, 120.0), lambda time: np.where(time < 60.0, time, 120.0 - time))
    trailing = columns(Hysteresis(5.0), at)[:, 0]
    np.testing.assert_array_equal(trailing[5:61], -5.0)
    np.testing.assert_allclose(trailing[60:71], np.arange(-5.0, 6.0), atol=1e-12)
    np.testing.assert_array_equal(trailing[70:], 5.0)


def test_hysteresis_of_five_plays_has_thresholds_about_its_own() -> None:
    at = conditions(np.arange(0.0, 60.0), lambda time: 60.0 - time)
    trailing = columns(Hysteresis(4.0, 2.0, plays=5.0), at)
    np.testing.assert_allclose(trailing[-1], [1.0, 2.0, 4.0, 8.0, 16.0], atol=1e-12)


def test_hysteresis_starts_on_the_side_that_its_past_has_left_it() -> None:
    at = conditions(np.arange(0.0, 30.0), lambda time: 60.0 - time)
    np.testing.assert_array_equal(columns(Hysteresis(5.0, before=60.0, offset=1.0), at)[:, 0], 5.0)
    trailing = columns(Hysteresis(5.0, before=60.0, offset=-1.0), at)[:, 0]
    np.testing.assert_allclose(trailing[:11], np.arange(-5.0, 6.0), atol=1e-12)


def test_bent_hysteresis_is_the_straight_one_times_x() -> None:
    straight, bent = np.hsplit(columns(Hysteresis(5.0, 1.5, 1.0, plays=3.0), conditions(SECONDS, ramp)), 2)
    np.testing.assert_allclose(bent, straight * (ramp(SECONDS)[:, None] - 25.0) / 35.0)


@pytest.mark.parametrize("exponent", [0.25, 0.5, 1.0, 2.0])
def test_rate_dependent_loop_is_a_power_of_the_rate(exponent: float) -> None:
    at = at_rest(rate=np.array([RATE, -4.0 * RATE, 0.0]))
    loop = columns(RateDependentHysteresis(exponent, 1e-6), at)[:, 0]
    np.testing.assert_allclose(loop, [1.0, -(4.0**exponent), 0.0], rtol=1e-6)


def test_rate_dependent_loop_is_1_at_1_degree_per_minute_above_any_floor() -> None:
    at = at_rest(rate=np.array([RATE, 1e-3 * RATE, 2e-3 * RATE]))
    loop = columns(RateDependentHysteresis(0.5, RATE), at)[:, 0]
    assert loop[0] == 1.0
    # Below the floor it is straight.
    assert loop[2] == pytest.approx(2.0 * loop[1], rel=1e-5)


def test_warm_up_is_down_to_1_over_e_after_its_time_constant() -> None:
    at = conditions(np.arange(0.0, 601.0), steady)
    np.testing.assert_allclose(columns(WarmUp(600.0), at)[[0, 600], 0], [1.0, np.exp(-1.0)])
    np.testing.assert_allclose(columns(WarmUp(600.0, 4.0), at)[600], np.exp([-2.0, -0.5]))


def test_warm_up_after_a_pause_is_less_than_after_a_long_rest() -> None:
    at = conditions(np.concatenate([np.arange(0.0, 601.0), np.arange(1200.0, 1800.0)]), steady)
    warming = columns(WarmUp(600.0), at)[:, 0]
    at_power_on = 1.0 - (1.0 - np.exp(-1.0)) * np.exp(-1.0)
    np.testing.assert_allclose(warming[601:], at_power_on * np.exp(-np.arange(600.0) / 600.0))


def test_aging_is_straight_or_logarithmic_and_held_in_the_end() -> None:
    at = conditions(np.array([-100.0, 3600.0, 7200.0, 1e6]), steady)
    np.testing.assert_allclose(columns(Aging(1e9, EPOCH, 7200.0), at)[:, 0], [0.0, 1.0, 2.0, 2.0], rtol=1e-5)
    slowing = columns(Aging(100.0, EPOCH, 7200.0), at)[:, 0]
    np.testing.assert_allclose(slowing[1:3], np.log([37.0, 73.0]) / 36.0)


def test_second_inputs_count_times_temperature_and_not_where_silent() -> None:
    # x is 1 at 60 °C.
    at = at_rest(temperature_2=np.array([62.0, np.nan, 59.0]), supply_voltage=np.array([3.4, np.nan, 3.2]))
    np.testing.assert_allclose(columns(ThermalGradient(), at), [[2.0, 2.0], [0.0, 0.0], [-1.0, -1.0]])
    np.testing.assert_allclose(columns(SupplyVoltage(3.3), at), [[0.1, 0.1], [0.0, 0.0], [-0.1, -0.1]])


def test_effects_of_the_input_follow_their_channel() -> None:
    acceleration = np.arange(18.0).reshape(3, 6)
    at = conditions(np.arange(3.0), lambda time: 25.0 + 35.0 * time, acceleration=acceleration)
    for channel, a in zip(CHANNELS, acceleration.T, strict=True):
        np.testing.assert_allclose(columns(QuadraticNonlinearity(channel), at)[:, 0], a**2)
        scale = columns(ScaleFactorTemperature(channel), at)
        np.testing.assert_allclose(scale, [[0.0, 0.0], [a[1], a[1]], [2.0 * a[2], 4.0 * a[2]]])
        np.testing.assert_array_equal(columns(CrossAxis(channel), at)[:, 0], a)


def test_cross_axis_without_samples_of_its_source_is_nothing() -> None:
    assert not columns(CrossAxis(CHANNELS[0]), at_rest(acceleration=np.full((3, 6), np.nan))).any()


@pytest.mark.filterwarnings("error")
def test_step_is_half_way_at_its_temperature_and_never_overflows() -> None:
    at = conditions(np.arange(3.0), lambda time: np.interp(time, [0.0, 1.0, 2.0], [30.0, 30.4, -1e6]))
    np.testing.assert_allclose(columns(ThresholdStep(30.0), at)[:, 0], [0.5, 1.0 / (1.0 + np.exp(-4.0)), 0.0])


def test_line_keeps_its_phase_after_two_years() -> None:
    # Stamps that float64 seconds since 1970 would put 0.1 µs away.
    tenths = np.array([1.0, 3.0, 7.0])
    at = conditions(2.0 * 32_000_000 + tenths / 10.0, steady)
    wave = columns(PeriodicInterference(2.0, EPOCH), at)
    np.testing.assert_allclose(wave[:, 0], np.sin(np.pi * tenths / 10.0), atol=5e-8)
    np.testing.assert_allclose(wave[:, 1], np.cos(np.pi * tenths / 10.0), atol=5e-8)


def test_harmonics_are_sines_of_multiples_of_the_frequency() -> None:
    seconds = np.arange(0.0, 50.0, 0.7)
    waves = columns(PeriodicInterference(10.0, EPOCH, 4.0), conditions(seconds, steady))
    phase = 2.0 * np.pi * seconds / 10.0
    expected = [wave(m * phase) for m in range(1, 5) for wave in (np.sin, np.cos)]
    np.testing.assert_allclose(waves, np.column_stack(expected), atol=1e-9)
    fundamental = columns(PeriodicInterference(10.0, EPOCH), conditions(seconds, steady))
    np.testing.assert_array_equal(waves[:, :2], fundamental)
