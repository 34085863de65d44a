"""Each effect of the catalogue does what its row says, and nothing else."""

from dataclasses import fields, replace

import numpy as np
import pytest
from simulation_scenarios import effect_on_z, quiet_scenario

from hgma_compensation.schema_check import load_schema
from hgma_compensation.simulation.description import (
    AppliedEffect,
    Axis,
    Heating,
    Oven,
    Powered,
    Step,
    Supply,
    Thermometer,
    VoltageStep,
)
from hgma_compensation.simulation.drift import static_drift
from hgma_compensation.simulation.effects import EFFECTS
from hgma_compensation.simulation.motion_description import Motion, Orientation, Shock, Vibration
from hgma_compensation.simulation.oven import temperatures
from hgma_compensation.simulation.oven_test import simulate, simulate_with_truth

SCHEMA = load_schema("hgma_compensation.simulation", "scenario.schema.json")["$defs"]
STILL = Oven(25.0, 30.0, (Step(25.0, 1.0, 200.0),))


def true_temperature(scenario):
    return simulate_with_truth(scenario).truth.temperature


def slope_at(scenario, second):
    axis = scenario.axes["z"]
    temperature = true_temperature(scenario)[second]
    low, high = static_drift(np.array([temperature - 0.5, temperature + 0.5]), axis)
    return high - low


def ramp(rate, low=25.0, high=60.0):
    return quiet_scenario(oven=Oven(low, 1.0, (Step(high, rate, 60.0),)))


def loop_at(values, temperature, level):
    """Return values on the way down minus values on the way up through a temperature."""
    up = np.flatnonzero((temperature[:-1] < level) & (temperature[1:] >= level))
    down = np.flatnonzero((temperature[:-1] >= level) & (temperature[1:] < level))
    return values[down[-1]] - values[up[-1]]


def there_and_back(rate):
    steps = (Step(-10.0, rate, 20.0), Step(60.0, rate, 20.0), Step(-10.0, rate, 20.0))
    return quiet_scenario(oven=Oven(25.0, 1.0, steps))


def test_every_effect_has_its_fields_in_the_published_schema():
    constants = {name for name, sub in SCHEMA.items() if "effect" in sub.get("properties", {})}
    assert constants == set(EFFECTS)
    for name, kind in EFFECTS.items():
        assert set(SCHEMA[name]["properties"]) - {"effect", "axes", "declare"} == {f.name for f in fields(kind)}


def test_an_effect_is_on_its_axes_only_and_nothing_is_left_when_it_is_off():
    axes = {"x": Axis(drift_span=300.0, white_noise=1.0), "z": Axis(drift_span=700.0, white_noise=1.0)}
    scenario = quiet_scenario(axes=axes)
    with_lag = replace(scenario, effects=(AppliedEffect("thermal_lag", EFFECTS["thermal_lag"](30.0), ("x",)),))
    on, off = simulate(with_lag), simulate(scenario)
    assert on.values[:, 2].tobytes() == off.values[:, 2].tobytes()
    assert np.abs(on.values[:, 0] - off.values[:, 0]).max() > 1.0


def test_thermal_lag_is_a_ramp_behind_by_its_time_constants():
    scenario = ramp(2.0)
    added = effect_on_z("thermal_lag", scenario, time_constant=40.0, second_time_constant=20.0)
    assert added[500] == pytest.approx(-60.0 * 2.0 / 60.0 * slope_at(scenario, 500), rel=0.05)
    assert added[-1] == pytest.approx(0.0, abs=1e-6)


def test_timing_offset_is_a_shift():
    scenario = ramp(2.0)
    added = effect_on_z("timing_offset", scenario, delay=30.0)
    assert added[500] == pytest.approx(-30.0 * 2.0 / 60.0 * slope_at(scenario, 500), rel=0.05)
    # Exactly as long after the corner as the delay, where a lag would decay.
    corner = int(35.0 / 2.0 * 60.0)
    assert abs(added[corner + 20]) > 0.1
    assert added[corner + 45] == pytest.approx(0.0, abs=1e-3)


def test_hysteresis_has_its_width_at_any_rate_and_closed_minor_loops():
    widths = []
    for rate in (1.0, 4.0):
        scenario = there_and_back(rate)
        added = effect_on_z("hysteresis", scenario, width=20.0, threshold=3.0, skew=0.0)
        widths.append(loop_at(added, true_temperature(scenario), 25.0))
    assert widths == pytest.approx([20.0, 20.0], rel=0.03)
    minor = (Step(60.0, 2.0, 5.0), Step(20.0, 2.0, 5.0), Step(30.0, 2.0, 5.0), Step(20.0, 2.0, 5.0))
    scenario = quiet_scenario(oven=Oven(-10.0, 1.0, (*minor, *minor[2:])))
    added, temperature = effect_on_z("hysteresis", scenario, width=20.0, threshold=3.0), true_temperature(scenario)
    ends = np.flatnonzero((temperature[1:-1] < 20.01) & (temperature[2:] >= 20.01))
    assert added[ends[-1]] == pytest.approx(added[ends[-2]], abs=0.05)
    assert 0.1 < loop_at(added, temperature, 25.0) < 10.0


def test_hysteresis_is_no_loop_of_the_same_shape_everywhere():
    scenario = there_and_back(2.0)
    added, temperature = effect_on_z("hysteresis", scenario, width=20.0, threshold=3.0), true_temperature(scenario)
    middle, end = loop_at(added, temperature, 25.0), loop_at(added, temperature, 45.0)
    assert middle == pytest.approx(20.0, rel=0.03)
    assert end < 0.9 * middle


def test_rate_dependent_hysteresis_grows_with_the_power_of_the_rate():
    slow, fast = (effect_on_z("rate_dependent_hysteresis", ramp(r), amplitude=3.0, exponent=0.5) for r in (1.0, 4.0))
    assert slow[300] == pytest.approx(3.0, rel=0.01)
    assert fast[300] == pytest.approx(6.0, rel=0.01)
    assert abs(slow[-1]) < 0.01


def test_warm_up_begins_at_each_power_on_and_less_after_a_short_break():
    powered = (Powered(0.0, 3000.0), Powered(3030.0, 4000.0), Powered(8000.0))
    scenario = quiet_scenario(oven=STILL, powered=powered)
    added = effect_on_z("warm_up", scenario, amplitude=10.0, time_constant=300.0)
    seconds = np.rint((simulate(scenario).stamps - simulate(scenario).stamps[0]) * 1e-9)
    assert added[299] == pytest.approx(10.0 * np.exp(-1.0), rel=0.01)
    assert added[seconds == 3030.0][0] == pytest.approx(10.0 * (1.0 - np.exp(-0.1)), rel=0.05)
    assert added[seconds == 8000.0][0] == pytest.approx(10.0, rel=0.01)


def test_aging_goes_with_time_or_its_logarithm():
    linear = effect_on_z("aging", rate=6.0)
    assert linear[3600] == pytest.approx(6.0)
    slowing = effect_on_z("aging", rate=6.0, logarithmic_after=1000.0)
    assert slowing[3600] == pytest.approx(6.0 / 3.6 * np.log(4.6))


def test_stress_relaxation_decays_in_a_soak_with_the_sign_of_the_ramp():
    steps = (Step(45.0, 20.0, 200.0), Step(25.0, 20.0, 10.0))
    scenario = quiet_scenario(oven=Oven(25.0, 1.0, steps))
    one = effect_on_z("stress_relaxation", scenario, gain=2.0, time_constant=2000.0, decades=0.0)
    # Less what decays and lags during the ramp of 60 s.
    assert one[60] == pytest.approx(40.0, rel=0.04)
    assert one[2060] == pytest.approx(40.0 * np.exp(-1.0), rel=0.04)
    spectrum = effect_on_z("stress_relaxation", scenario, gain=2.0, time_constant=2000.0, decades=0.6)
    # Broader than one exponential: sooner at first, later at last.
    assert spectrum[260] < one[260]
    assert spectrum[10_000] > 2.0 * one[10_000]
    assert spectrum[-1] < 0.0


def test_thermal_gradient_follows_the_difference_at_constant_temperature():
    second = Thermometer(1.0, 0.0, lag=60.0, heating=(Heating(1000.0, 3000.0, 4.0),))
    scenario = quiet_scenario(oven=STILL, second_thermometer=second)
    added = effect_on_z("thermal_gradient", scenario, gain=3.0, bend=0.5)
    assert added[900] == pytest.approx(0.0, abs=1e-9)
    assert added[2900] == pytest.approx(12.0, rel=1e-3)
    shown = simulate(scenario).temperature_2.values
    assert added == pytest.approx(3.0 * (shown[: len(added)] - 25.0), abs=1e-6)


def test_supply_voltage_effect_follows_the_supply_and_the_temperature():
    supply = Supply(1.0, 5.0, steps=(VoltageStep(1000.0, 0.1),))
    scenario = quiet_scenario(supply=supply, oven=Oven(60.0, 30.0, (Step(60.0, 1.0, 60.0),)))
    added = effect_on_z("supply_voltage", scenario, gain=40.0, temperature_gain=10.0)
    assert (added[:1000] == 0.0).all()
    assert added[1000:] == pytest.approx(5.0)


def test_the_scale_factor_changes_with_temperature_and_the_sign_of_the_input():
    flips = Motion(orientations=(Orientation(1000.0, (0.0, 0.0, -100.0)), Orientation(2000.0, (0.0, 0.0, 100.0))))
    scenario = quiet_scenario(motion=flips, oven=Oven(60.0, 30.0, (Step(60.0, 1.0, 60.0),)))
    added = effect_on_z("scale_factor_temperature", scenario, linear=-0.05, quadratic=0.01)
    assert added[1500] == pytest.approx(4.0)
    assert added[2500] == pytest.approx(-4.0)
    assert effect_on_z("scale_factor_temperature", replace(scenario, oven=STILL), linear=-0.05)[1500] == 0.0


def test_the_quadratic_nonlinearity_is_even():
    flips = Motion(orientations=(Orientation(1000.0, (0.0, 0.0, -100.0)), Orientation(2000.0, (0.0, 0.0, 50.0))))
    added = effect_on_z("quadratic_nonlinearity", quiet_scenario(motion=flips), fraction=0.02, level=100.0)
    assert added[1500] == pytest.approx(2.0)
    assert added[2500] == pytest.approx(0.5)


def test_vibration_rectifies_even_above_half_the_sample_rate():
    vibrations = (Vibration(1000.0, 3000.0, "z", 4.0, 200.0, 900.0), Vibration(3500.0, 4000.0, "x", 4.0, 200.0, 900.0))
    scenario = quiet_scenario(motion=Motion(vibrations=vibrations), oven=STILL)
    added = effect_on_z("vibration_rectification", scenario, coefficient=-0.5, time_constant=20.0)
    assert added[999] == 0.0
    assert added[1019] == pytest.approx(-8.0 * (1.0 - np.exp(-1.0)), rel=0.01)
    assert added[2900] == pytest.approx(-8.0)
    assert added[3990] == pytest.approx(0.0, abs=1e-6)


def test_the_zero_shifts_after_shocks_only():
    shocks = (Shock(1000.0, "z", 1e4, 0.5), Shock(2000.0, "z", -2e4, 0.5), Shock(3000.0, "x", 9e4, 0.5))
    small = Shock(4000.0, "z", 1e3, 0.5)
    scenario = quiet_scenario(motion=Motion(shocks=(*shocks, small)), oven=STILL)
    added = effect_on_z(
        "post_shock_zero_shift", scenario, permanent=1e-3, transient=2e-3, time_constant=50.0, threshold=5e3
    )
    assert added[1000] == 0.0
    assert added[1001] == pytest.approx(10.0 + 20.0 * np.exp(-0.5 / 50.0))
    assert added[1900] == pytest.approx(10.0, abs=1e-3)
    assert added[-1] == pytest.approx(-10.0, abs=1e-3)


def test_the_threshold_step_is_the_same_on_every_pass():
    scenario = there_and_back(2.0)
    added = effect_on_z("threshold_step", scenario, temperature=30.0, height=6.0)
    temperature = true_temperature(scenario)
    assert added == pytest.approx(6.0 / (1.0 + np.exp(-(temperature - 30.0) * 2.0 * np.log(9.0) / 0.4)))
    assert added[temperature < 29.0].max() < 0.01
    assert added[temperature > 31.0].min() > 5.99


def test_cross_axis_follows_the_other_axis():
    flips = Motion(orientations=(Orientation(1000.0, (0.0, 50.0, 9.81)),))
    axes = {"y": Axis(), "z": Axis(true_value=9.81)}
    added = effect_on_z("cross_axis", quiet_scenario(motion=flips, axes=axes), source="y", gain=0.02)
    assert (added[:1000] == 0.0).all()
    assert added[1001:] == pytest.approx(1.0)


def test_periodic_interference_is_a_line():
    added = effect_on_z("periodic_interference", period=100.0, amplitude=2.0, phase=0.5)
    assert added == pytest.approx(2.0 * np.sin(2.0 * np.pi * np.arange(len(added)) / 100.0 + 0.5))


def test_humidity_is_slow_and_shows_nowhere_else():
    scenario = quiet_scenario(oven=Oven(25.0, 30.0, (Step(25.0, 1.0, 2880.0),)), accelerometer_rate=0.1)
    added = effect_on_z("humidity", scenario, gain=0.5, time_constant=3600.0, swing=10.0)
    passed = 1.0 / np.hypot(1.0, 2.0 * np.pi * 3600.0 / 86400.0)
    assert np.ptp(added[8640:]) == pytest.approx(2.0 * 0.5 * 10.0 * passed, rel=0.01)
    wandering = effect_on_z("humidity", scenario, gain=0.5, time_constant=0.0, swing=0.0, wander=4.0)
    assert 0.3 < wandering.std() < 4.0


def test_a_random_walk_grows_with_the_root_of_time():
    scenario = quiet_scenario(oven=Oven(25.0, 30.0, (Step(25.0, 1.0, 2000.0),)))
    added = effect_on_z("random_walk", scenario, coefficient=0.3)
    assert added[0] == 0.0
    assert np.diff(added).std() == pytest.approx(0.3, rel=0.02)
    assert np.corrcoef(np.diff(added)[1:], np.diff(added)[:-1])[0, 1] == pytest.approx(0.0, abs=0.02)


def test_telegraph_noise_has_two_levels_and_its_mean_stays():
    scenario = quiet_scenario(oven=Oven(25.0, 30.0, (Step(25.0, 1.0, 3000.0),)))
    added = effect_on_z("telegraph_noise", scenario, amplitude=5.0, mean_low=30.0, mean_high=90.0)
    assert set(np.round(added, 9)) == {0.0, 5.0}
    assert added.mean() == pytest.approx(5.0 * 0.75, rel=0.05)
    jumps = np.count_nonzero(np.diff(added))
    assert jumps == pytest.approx(2.0 * len(added) / 120.0, rel=0.1)


def test_the_oven_of_these_tests_reaches_what_it_is_told():
    oven = temperatures(there_and_back(2.0).oven)
    assert oven.sensor.max() == pytest.approx(60.0, abs=1e-3)
    assert oven.sensor.min() == pytest.approx(-10.0, abs=1e-3)
