import re
from dataclasses import replace

import numpy as np
import pytest
import yaml
from jsonschema import Draft202012Validator
from simulation_scenarios import CYCLE, PARAMS, ROOT, quiet_scenario, write_scenario

from hgma_compensation.cli.main import main
from hgma_compensation.recording.bag_reader import read_recording
from hgma_compensation.schema_check import load_schema
from hgma_compensation.simulation.description import Axis, Oven, Powered, Ripple, Step, Supply, Thermometer, VoltageStep
from hgma_compensation.simulation.drift import static_drift
from hgma_compensation.simulation.effects import EFFECTS
from hgma_compensation.simulation.oven import temperatures
from hgma_compensation.simulation.oven_test import EPOCH, simulate
from hgma_compensation.simulation.scenario import read_scenario

GRAVITY = 9.80665


@pytest.mark.parametrize("name", ["oven_test.yaml", "paper_oven_test.yaml"])
def test_the_raw_span_of_the_shipped_scenarios_is_that_of_the_paper(name):
    scenario = read_scenario(PARAMS / name)
    low, high = static_drift(np.array([-10.0, 60.0]), scenario.axes["z"])
    assert (high - low) / GRAVITY == pytest.approx(5367.0, rel=1e-4)
    assert static_drift(np.array([25.0]), scenario.axes["z"])[0] == 0.0
    minute = int(60.0 * scenario.accelerometer_rate)
    values = simulate(scenario).values[:, 2]
    means = values[: len(values) // minute * minute].reshape(-1, minute).mean(axis=1)
    assert np.ptp(means) / GRAVITY == pytest.approx(5367.0, rel=0.02)


def test_the_held_out_cycle_of_the_paper_has_a_rate_that_training_lacks():
    rates = [step.rate for step in read_scenario(PARAMS / "paper_oven_test.yaml").oven.program]
    assert {0.7, 1.0, 2.0} == set(rates[:-3])
    assert {1.5} == set(rates[-3:])


def test_the_sensor_lags_the_set_point_by_the_time_constant():
    oven = temperatures(Oven(20.0, 60.0, (Step(30.0, 1e3, 10.0),)))
    after_one = oven.sensor[np.searchsorted(oven.time, 0.6 + 60.0)]
    # The ramp of 0.6 s is a step to within 0.6 / 60 of the time constant.
    assert (after_one - 20.0) / 10.0 == pytest.approx(1.0 - np.exp(-1.0), abs=0.01)
    assert oven.sensor[0] == 20.0
    assert oven.sensor[-1] == pytest.approx(30.0, abs=10.0 * np.exp(-10.0) + 1e-6)


def test_the_sensor_sees_the_ripple_of_the_chamber_as_a_low_pass_leaves_it():
    oven = temperatures(Oven(20.0, 60.0, (Step(20.0, 1.0, 60.0),), ripple=Ripple(0.5, 120.0)))
    settled = oven.time > 600.0
    assert np.ptp(oven.chamber[settled]) == pytest.approx(1.0, rel=1e-3)
    passed = 1.0 / np.hypot(1.0, 2.0 * np.pi * 60.0 / 120.0)
    assert np.ptp(oven.sensor[settled]) == pytest.approx(passed, rel=0.01)


def test_the_thermistor_has_its_lag_its_noise_and_its_resolution():
    ramp = Oven(0.0, 1.0, (Step(50.0, 6.0, 0.0),))
    lagging = simulate(quiet_scenario(oven=ramp, thermistor_lag=20.0)).temperature.values
    prompt = simulate(quiet_scenario(oven=ramp)).temperature.values
    # On a ramp of 0.1 °C/s a lag of 20 s is 2 °C.
    assert (prompt - lagging)[200:] == pytest.approx(2.0, abs=0.02)
    rounded = simulate(quiet_scenario(oven=ramp, thermistor_resolution=0.25, thermistor_noise=0.1)).temperature.values
    np.testing.assert_array_equal(rounded, 0.25 * np.rint(rounded / 0.25))
    assert (rounded - prompt).std() == pytest.approx(np.hypot(0.1, 0.25 / np.sqrt(12.0)), rel=0.15)


def test_second_thermometer_and_supply_are_recorded():
    supply = Supply(2.0, 5.0, noise=0.001, steps=(VoltageStep(3000.0, -0.2),))
    second = Thermometer(0.5, 0.0, lag=100.0)
    recording = simulate(quiet_scenario(supply=supply, second_thermometer=second))
    seconds = (recording.supply_voltage.stamps - EPOCH) * 1e-9
    assert recording.supply_voltage.values[seconds < 3000.0].mean() == pytest.approx(5.0, abs=1e-4)
    assert recording.supply_voltage.values[seconds >= 3000.0].mean() == pytest.approx(4.8, abs=1e-4)
    assert np.diff(recording.temperature_2.stamps)[0] == 2_000_000_000
    # Heating at 2 °C/min, the package at 100 s is 70 s behind the sensor at 30 s.
    assert np.interp(600.0, (recording.temperature.stamps - EPOCH) * 1e-9, recording.temperature.values) - np.interp(
        600.0, (recording.temperature_2.stamps - EPOCH) * 1e-9, recording.temperature_2.values
    ) == pytest.approx(70.0 * 2.0 / 60.0, rel=0.01)


def test_a_sensor_without_power_gives_no_sample():
    recording = simulate(quiet_scenario(powered=(Powered(0.0, 1000.0), Powered(2000.0))))
    for stamps in (recording.stamps, recording.temperature.stamps, recording.temperature_2.stamps):
        seconds = (stamps - EPOCH) * 1e-9
        assert not ((seconds >= 1000.0) & (seconds < 2000.0)).any()
        assert len(stamps) == int(CYCLE.duration) - 1000
    whole = simulate(quiet_scenario())
    assert recording.values[-1].tobytes() == whole.values[-1].tobytes()


def test_readings_stop_at_full_scale_and_come_in_counts():
    axis = Axis(true_value=0.0, drift_span=700.0, full_scale=200.0, lsb=0.5)
    values = simulate(quiet_scenario(axes={"z": axis})).values[:, 2]
    assert values.max() == 200.0
    assert values.min() == -200.0
    np.testing.assert_array_equal(values, 0.5 * np.rint(values / 0.5))


def test_a_seed_gives_the_same_recording_and_another_seed_another(tmp_path):
    scenario = read_scenario(write_scenario(tmp_path))
    one, same, other = simulate(scenario), simulate(scenario), simulate(replace(scenario, seed=2))
    assert one.values.tobytes() == same.values.tobytes()
    assert one.temperature.values.tobytes() == same.temperature.values.tobytes()
    assert one.values.tobytes() != other.values.tobytes()


@pytest.mark.parametrize("storage", ["mcap", "sqlite3"])
def test_a_seed_gives_the_same_bag_byte_for_byte(tmp_path, storage):
    path = write_scenario(tmp_path, ground_truth=True, effects=[{"effect": "aging", "rate": 5.0, "declare": True}])
    for folder in ("one", "two"):
        (tmp_path / folder).mkdir()
        assert main(["simulate", str(path), "-o", str(tmp_path / folder / "bag"), "--storage", storage]) == 0
    files = sorted(file.name for file in (tmp_path / "one" / "bag").iterdir())
    assert len(files) == 2
    for name in files:
        assert (tmp_path / "one" / "bag" / name).read_bytes() == (tmp_path / "two" / "bag" / name).read_bytes()


def test_one_source_of_noise_does_not_disturb_another():
    noisy = {"z": Axis(white_noise=1.0)}
    plain = simulate(quiet_scenario(axes=noisy, thermistor_noise=0.1))
    more = simulate(quiet_scenario(axes={"x": Axis(white_noise=2.0), **noisy}, thermistor_noise=0.0))
    assert plain.values[:, 2].tobytes() == more.values[:, 2].tobytes()


@pytest.mark.parametrize("name", ["oven_test", "shock"])
def test_the_shipped_bag_is_what_the_shipped_scenario_makes(name):
    shipped, made = read_recording(ROOT / "bags" / name), simulate(read_scenario(PARAMS / f"{name}.yaml"))
    np.testing.assert_array_equal(shipped.stamps, made.stamps)
    # Another version of numpy may round its exponential differently; noise and drift are far above that.
    np.testing.assert_allclose(shipped.values, made.values, rtol=1e-12, atol=1e-9)
    np.testing.assert_allclose(shipped.temperature.values, made.temperature.values, rtol=1e-12)


def test_the_shipped_bags_are_small():
    assert sum(file.stat().st_size for file in (ROOT / "bags").rglob("*")) < 5_000_000


SCENARIOS = sorted(path for path in PARAMS.glob("*.yaml") if re.search(r"^scenario: ", path.read_text(), re.MULTILINE))


@pytest.mark.parametrize("path", SCENARIOS, ids=lambda path: path.name)
def test_every_shipped_scenario_follows_the_published_schema(path):
    schema = load_schema("hgma_compensation.simulation", "scenario.schema.json")
    Draft202012Validator(schema).validate(yaml.safe_load(path.read_text(encoding="utf-8")))
    assert read_scenario(path).oven.duration > 0.0


def test_the_whole_catalogue_can_be_asked_for_in_one_scenario(tmp_path):
    schema = load_schema("hgma_compensation.simulation", "scenario.schema.json")
    some = {"source": "y", "temperature": 30.0, "exponent": 0.5, "permanent": 0.001, "fraction": 0.02}
    required = {name: set(schema["$defs"][name]["required"]) - {"effect"} for name in EFFECTS}
    effects = [{"effect": name, **{key: some.get(key, 0.5) for key in keys}} for name, keys in required.items()]
    sections = {"second_thermometer": {"rate": 1.0, "noise": 0.01}, "supply_voltage": {"rate": 1.0, "nominal": 5.0}}
    path = write_scenario(tmp_path, effects=effects, **sections)
    Draft202012Validator(schema).validate(yaml.safe_load(path.read_text()))
    with_all, without = simulate(read_scenario(path)), simulate(read_scenario(write_scenario(tmp_path)))
    assert np.isfinite(with_all.values).all()
    assert np.abs(with_all.values - without.values).max() > 1.0


def test_the_programme_lasts_as_long_as_its_steps():
    assert CYCLE.duration == pytest.approx(60.0 * (17.5 + 35.0 + 17.5 + 30.0))
