from pathlib import Path

import numpy as np
import pytest
import yaml

from hgma_compensation.errors import RefusedError
from hgma_compensation.recording.bag_reader import read_recording
from hgma_compensation.simulation.oven_test import sensor_temperature, simulate, static_drift
from hgma_compensation.simulation.scenario import Axis, Oven, Step, read_scenario

ROOT = Path(__file__).parents[1]
SCENARIO = ROOT / "params" / "oven_test.yaml"


def short_scenario(tmp_path, **changes):
    document = yaml.safe_load(SCENARIO.read_text())
    document["oven"]["program"] = [{"to": 35.0, "rate": 10.0, "soak": 1.0}]
    document.update(changes)
    path = tmp_path / "scenario.yaml"
    path.write_text(yaml.safe_dump(document))
    return path


def test_the_drift_of_the_shipped_scenario_has_the_span_of_the_paper():
    axis = read_scenario(SCENARIO).axes["z"]
    low, high = static_drift(np.array([-10.0, 60.0]), axis)
    assert (high - low) / 9.80665 == pytest.approx(5367.0, rel=1e-4)
    assert static_drift(np.array([25.0]), axis)[0] == 0.0


def test_the_sensor_lags_the_set_point_by_the_time_constant():
    oven = Oven(20.0, 60.0, (Step(30.0, 1e3, 10.0),))
    time, temperature = sensor_temperature(oven)
    after_one = temperature[np.searchsorted(time, 0.6 + 60.0)]
    # The ramp of 0.6 s is a step to within 0.6 / 60 of the time constant.
    assert (after_one - 20.0) / 10.0 == pytest.approx(1.0 - np.exp(-1.0), abs=0.01)
    assert temperature[0] == 20.0
    assert temperature[-1] == pytest.approx(30.0, abs=10.0 * np.exp(-10.0) + 1e-6)


def test_the_noise_is_the_one_asked_for(tmp_path):
    scenario = read_scenario(short_scenario(tmp_path))
    quiet = simulate(scenario.__class__(**{**scenario.__dict__, "axes": {"z": Axis(9.81, 0.0, 0.0, 46.66)}}))
    deviation = quiet.values[:, 2].std()
    assert deviation == pytest.approx(46.66 * np.sqrt(2.0), rel=4.0 / np.sqrt(2.0 * len(quiet.stamps)))


def test_a_seed_gives_the_same_recording_and_another_seed_another(tmp_path):
    one, same = (simulate(read_scenario(short_scenario(tmp_path))) for _ in range(2))
    other = simulate(read_scenario(short_scenario(tmp_path, seed=2)))
    assert one.values.tobytes() == same.values.tobytes()
    assert one.temperature.values.tobytes() == same.temperature.values.tobytes()
    assert one.values.tobytes() != other.values.tobytes()


def test_the_shipped_bag_is_what_the_shipped_scenario_makes():
    shipped, made = read_recording(ROOT / "bags" / "oven_test"), simulate(read_scenario(SCENARIO))
    np.testing.assert_array_equal(shipped.stamps, made.stamps)
    # Another version of numpy may round its exponential differently; noise and drift are far above that.
    np.testing.assert_allclose(shipped.values, made.values, rtol=1e-12)
    np.testing.assert_allclose(shipped.temperature.values, made.temperature.values, rtol=1e-12)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"seed": -1}, "seed is -1, must be at least 0"),
        ({"seed": "many"}, "seed is 'many', must be an integer"),
        ({"oven": {"start": 25.0}}, "oven lacks the field 'time_constant'"),
        ({"colour": "red"}, "unknown field 'colour'"),
        ({"accelerometer": {"rate": 2.0, "axes": {}}}, "accelerometer.axes is empty"),
        ({"accelerometer": {"rate": float("nan"), "axes": {}}}, "accelerometer.rate is not finite"),
        ({"accelerometer": {"rate": 1e6, "axes": {}}}, "describe at least one|samples"),
    ],
)
def test_a_wrong_scenario_is_refused_with_its_field(tmp_path, changes, message):
    with pytest.raises(RefusedError, match=message):
        read_scenario(short_scenario(tmp_path, **changes))


@pytest.mark.parametrize("text", ["a: [", "!!python/object/apply:os.getcwd []", "just words", ""])
def test_a_file_that_is_no_scenario_is_refused_and_never_executed(tmp_path, text):
    (tmp_path / "bad.yaml").write_text(text)
    with pytest.raises(RefusedError, match=r"bad\.yaml"):
        read_scenario(tmp_path / "bad.yaml")
