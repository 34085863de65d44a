from dataclasses import replace

import numpy as np
import pytest
import yaml
from simulation_scenarios import PARAMS, quiet_scenario, write_scenario

from hgma_compensation.cli.main import main
from hgma_compensation.measured_data import chamber_table
from hgma_compensation.recording.bag_reader import read_recording
from hgma_compensation.recording.csv_table import STANDARD_GRAVITY
from hgma_compensation.recording.ground_truth import DECLARED_EFFECTS
from hgma_compensation.simulation.description import Axis, FirstMode, Oven, Step
from hgma_compensation.simulation.motion_description import Motion, Orientation, Shock, Vibration, Waveform
from hgma_compensation.simulation.oven_test import simulate, simulate_with_truth
from hgma_compensation.simulation.scenario import read_scenario
from hgma_compensation.topics import TopicNames


def resting(seconds, rate, motion, **changes):
    """Return a scenario without drift or noise at 25 °C."""
    oven = Oven(25.0, 30.0, (Step(25.0, 1.0, seconds / 60.0),))
    axes = {"z": Axis(true_value=0.0), "y": Axis(true_value=0.0)}
    return quiet_scenario(**{"oven": oven, "accelerometer_rate": rate, "axes": axes, "motion": motion, **changes})


def test_orientations_are_held_one_after_the_other():
    flips = (Orientation(10.0, (0.0, 0.0, -9.8)), Orientation(20.0, (0.0, 9.8, 0.0), turn=2.0))
    values = simulate(resting(30.0, 10.0, Motion(orientations=flips))).values
    assert (values[:100, 1:3] == 0.0).all()
    assert values[112:200, 2] == pytest.approx(-9.8)
    assert values[210, 1:3] == pytest.approx([4.9, -4.9])
    assert values[221:, 1] == pytest.approx(9.8)


def test_a_shock_has_its_peak_and_the_velocity_change_of_a_half_sine():
    shock = Shock(0.5, "z", 1e5, 1e-3)
    values = simulate(resting(1.0, 100_000.0, Motion(shocks=(shock,)))).values[:, 2]
    assert values.max() == pytest.approx(1e5, rel=1e-3)
    assert values.sum() / 100_000.0 == pytest.approx(2.0 / np.pi * 1e5 * 1e-3, rel=1e-3)


def test_the_shipped_shocks_reach_ten_thousand_g():
    simulated = simulate_with_truth(read_scenario(PARAMS / "shock.yaml"))
    true = simulated.truth.acceleration[:, 2] / STANDARD_GRAVITY
    assert true.max() == pytest.approx(10_001.0, rel=1e-3)
    assert true.min() == pytest.approx(-9_999.0, rel=1e-3)
    # White noise of 4.76 g/√Hz is 476 g in one sample at 10 kHz.
    noise = simulated.recording.values[:, 2] - simulated.truth.acceleration[:, 2] - simulated.truth.drift[:, 2]
    assert noise.std() / STANDARD_GRAVITY == pytest.approx(476.0, rel=0.02)


@pytest.mark.parametrize(("low", "high"), [(20.0, 20.0), (10.0, 40.0)])
def test_vibration_has_its_rms_in_its_band_while_it_lasts(low, high):
    vibration = Vibration(10.0, 50.0, "z", 3.0, low, high)
    values = simulate(resting(60.0, 200.0, Motion(vibrations=(vibration,)))).values[:, 2]
    assert (values[:2000] == 0.0).all()
    assert (values[10_000:] == 0.0).all()
    assert values[2000:10_000].std() == pytest.approx(3.0, rel=0.01)
    power = np.abs(np.fft.rfft(values[2000:10_000])) ** 2
    frequency = np.fft.rfftfreq(8000, 1.0 / 200.0)
    assert power[(frequency > 0.7 * low) & (frequency < 1.4 * high)].sum() > 0.95 * power.sum()


def test_vibration_above_half_the_rate_leaves_no_samples():
    vibration = Vibration(10.0, 50.0, "z", 3.0, 120.0, 500.0)
    assert (simulate(resting(60.0, 200.0, Motion(vibrations=(vibration,)))).values == 0.0).all()


def test_a_waveform_keeps_its_velocity_change_at_a_lower_rate():
    times = np.arange(0.0, 1e-3, 1e-6)
    waveform = Waveform("z", 0.5 + times, 1e5 * np.sin(np.pi * times / 1e-3))
    for rate in (2000.0, 10_000.0, 300_000.0):
        values = simulate(resting(1.0, rate, Motion(waveforms=(waveform,)))).values[:, 2]
        assert values.sum() / rate == pytest.approx(2.0 / np.pi * 1e5 * 1e-3, rel=1e-3)


def test_a_measured_waveform_is_read_with_its_units(tmp_path):
    (tmp_path / "drop.csv").write_text("t,a\n" + "".join(f"{i},{min(i, 100 - i) / 10}\n" for i in range(101)))
    waveform = {"file": "drop.csv", "time": 1.0, "axis": "z", "time_column": "t", "column": "a"}
    waveform |= {"time_unit": "us", "unit": "kg", "stretch": 1000.0, "scale": -1.0}
    path = write_scenario(tmp_path, "shock.yaml", motion={"waveforms": [waveform]})
    true = simulate_with_truth(read_scenario(path)).truth.acceleration[:, 2] / STANDARD_GRAVITY
    assert true.min() == pytest.approx(1.0 - 5000.0, rel=1e-3)
    assert true.argmin() == pytest.approx(10_000 * 1.05, abs=1)


@pytest.mark.skipif(chamber_table() is None, reason="no measured data here")
def test_a_drop_tower_shock_can_be_injected(tmp_path):
    file = chamber_table().parents[1] / "drop_tower_shock" / "accel_5.csv"
    waveform = {"file": str(file), "time": 0.1, "axis": "z", "time_column": "t_s", "column": "test1_kg"}
    waveform |= {"time_unit": "s", "unit": "kg"}
    path = write_scenario(tmp_path, "shock.yaml", motion={"waveforms": [waveform]})
    scenario = replace(read_scenario(path), accelerometer_rate=1e6, oven=Oven(25.0, 9.0, (Step(25.0, 1.0, 0.01),)))
    true = simulate_with_truth(scenario).truth.acceleration[:, 2] / STANDARD_GRAVITY
    column = np.loadtxt(file, delimiter=",", skiprows=1, usecols=1)
    assert true.max() == pytest.approx(1000.0 * column.max(), rel=0.02)
    assert true.sum() == pytest.approx(1000.0 * column.sum() + len(true), rel=1e-3)


def test_the_first_mode_rings_where_the_rate_resolves_it_only():
    mode = FirstMode(1000.0, 20.0)
    step = Motion(orientations=(Orientation(0.1, (0.0, 0.0, 10.0), turn=1e-6),))
    values = simulate(resting(0.6, 50_000.0, step, first_mode=mode)).values[:, 2]
    # A step overshoots by e^(−π/2Q), and settles at its height.
    assert values.max() == pytest.approx(10.0 * (1.0 + np.exp(-np.pi / 40.0)), rel=0.01)
    assert values[-1] == pytest.approx(10.0, rel=1e-3)
    slow = simulate(resting(0.6, 2000.0, step, first_mode=mode)).values[:, 2]
    assert slow.max() == 10.0


def test_ground_truth_is_written_where_asked_with_the_stamps_of_the_accelerometer(tmp_path):
    effects = [{"effect": "aging", "rate": 5.0}, {"effect": "cross_axis", "source": "y", "gain": 0.1, "declare": True}]
    path = write_scenario(tmp_path, effects=effects, ground_truth=True)
    assert main(["simulate", str(path), "-o", str(tmp_path / "bag")]) == 0
    raw = read_recording(tmp_path / "bag")
    truth = simulate_with_truth(read_scenario(path)).truth
    for topic, expected in (("drift", truth.drift), ("acceleration", truth.acceleration)):
        written = read_recording(tmp_path / "bag", TopicNames([f"/accel/raw:=/ground_truth/{topic}"]))
        np.testing.assert_array_equal(written.stamps, raw.stamps)
        np.testing.assert_array_equal(written.values[:, :3], expected)
    temperature = read_recording(tmp_path / "bag", TopicNames(["/accel/temperature:=/ground_truth/temperature"]))
    np.testing.assert_array_equal(temperature.temperature.values, truth.temperature)
    metadata = (tmp_path / "bag" / "metadata.yaml").read_text()
    assert DECLARED_EFFECTS in metadata
    assert "cross_axis" in metadata
    assert "aging" not in metadata


def test_no_ground_truth_is_written_where_it_is_not_asked_for(tmp_path):
    path = write_scenario(tmp_path, effects=[{"effect": "aging", "rate": 5.0, "declare": True}])
    assert main(["simulate", str(path), "-o", str(tmp_path / "bag")]) == 0
    metadata = (tmp_path / "bag" / "metadata.yaml").read_text()
    assert "ground_truth" not in metadata
    assert "aging" not in metadata


def test_a_high_rate_is_written_in_blocks_that_read_as_the_same_samples(tmp_path):
    scenario = yaml.safe_load((PARAMS / "shock.yaml").read_text())
    scenario["accelerometer"]["block"] = 256
    scenario["power"] = [{"start": 0.0, "end": 0.9}, {"start": 1.0}]
    path = write_scenario(tmp_path, "shock.yaml", accelerometer=scenario["accelerometer"], power=scenario["power"])
    path.write_text(path.read_text().replace("soak: 1.0", "soak: 0.04").replace("to: 35.0", "to: 25.0"))
    assert main(["simulate", str(path), "-o", str(tmp_path / "bag")]) == 0
    read, made = read_recording(tmp_path / "bag"), simulate(read_scenario(path))
    np.testing.assert_array_equal(read.stamps, made.stamps)
    np.testing.assert_allclose(read.values, made.values, rtol=1e-6)
    assert "/accel/raw_block" in (tmp_path / "bag" / "metadata.yaml").read_text()
