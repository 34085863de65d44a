import pytest
from simulation_scenarios import write_scenario

from hgma_compensation.errors import RefusedError
from hgma_compensation.simulation.scenario import read_scenario


def accelerometer(**axis):
    return {"accelerometer": {"rate": 2.0, "axes": {"z": axis}}}


def effects(*entries):
    return {"effects": list(entries)}


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"seed": -1}, "seed is -1, must be at least 0"),
        ({"seed": "many"}, "seed is 'many', must be an integer"),
        ({"oven": {"start": 25.0}}, "oven lacks the field 'time_constant'"),
        ({"colour": "red"}, "unknown field 'colour'"),
        ({"accelerometer": {"rate": 2.0, "axes": {}}}, "accelerometer.axes is empty"),
        ({"accelerometer": {"rate": float("nan"), "axes": {}}}, "accelerometer.rate is not finite"),
        ({"accelerometer": {"rate": 1e7, "axes": {"z": {}}}}, "samples: 2 to"),
        ({"accelerometer": {"rate": 1e-3, "axes": {"z": {}}}}, "less than two samples"),
        (accelerometer(drift_span=1.0, drift_span_g=1.0), "axes.z gives drift_span twice"),
        (accelerometer(white_noise=-1.0), "axes.z.white_noise is -1.0, must be at least 0"),
        ({"power": [{"start": 0.0, "end": 50.0}, {"start": 40.0}]}, r"power\[1\] must start at 50 s or later"),
        ({"power": [{"start": 1e6}]}, r"power\[0\] must start"),
        (
            {"motion": {"shocks": [{"time": 999, "axis": "z", "peak_g": 1, "width": 1}]}},
            r"shocks\[0\] is at 999 s, but",
        ),
        (
            {"supply_voltage": {"rate": 1, "nominal": 5, "steps": [{"time": 999, "change": 1}]}},
            r"steps\[0\] is at 999 s",
        ),
        (
            {"second_thermometer": {"rate": 1, "noise": 0, "heating": [{"start": 9, "end": 5, "rise": 1}]}},
            r"heating\[0\].end is not after",
        ),
        (effects({"effect": "magic"}), r"effects\[0\].effect is 'magic', must be one of 'aging'"),
        (effects({"effect": "aging"}), r"effects\[0\] lacks the field 'rate'"),
        (effects({"effect": "aging", "rate": 1.0, "axes": ["x"]}), r"effects\[0\].axes names 'x'"),
        (effects({"effect": "supply_voltage", "gain": 1.0}), "needs the section 'supply_voltage'"),
        (effects({"effect": "thermal_gradient", "gain": 1.0}), "needs the section 'second_thermometer'"),
        ({"motion": {"shocks": [{"time": 0, "axis": "w", "peak_g": 1, "width": 1}]}}, "must be one of 'x', 'y', 'z'"),
        ({"motion": {"shocks": [{"time": 0, "axis": "z", "peak_g": 1e6, "width": 1}]}}, "peak_g is 1000000.0"),
        (
            {"motion": {"vibrations": [{"start": 0, "end": 9, "axis": "z", "rms_g": 1, "band": [5, 1]}]}},
            r"vibrations\[0\].band must rise",
        ),
        (
            {"motion": {"vibrations": [{"start": 9, "end": 9, "axis": "z", "rms_g": 1, "band": [1, 2]}]}},
            r"vibrations\[0\].end is not after",
        ),
    ],
)
def test_a_wrong_scenario_is_refused_with_its_file_and_field(tmp_path, changes, message):
    path = write_scenario(tmp_path, **changes)
    with pytest.raises(RefusedError, match=message) as refusal:
        read_scenario(path)
    assert str(path) in str(refusal.value)


@pytest.mark.parametrize("text", ["a: [", "!!python/object/apply:os.getcwd []", "just words", ""])
def test_a_file_that_is_no_scenario_is_refused_and_never_executed(tmp_path, text):
    (tmp_path / "bad.yaml").write_text(text)
    with pytest.raises(RefusedError, match=r"bad\.yaml"):
        read_scenario(tmp_path / "bad.yaml")


@pytest.mark.parametrize(
    ("table", "message"),
    [
        (None, "cannot be read"),
        ("time,a\n0,1\n1,2\n", "has no column 't'"),
        ("t,a\n0,1\n0,2\n", "times that increase"),
        ("t,a\n0,1\n1,x\n", "line 3: column 'a' holds no finite number: remove the row$"),
        ("t,a\n0,1\n1,nan\n", "no finite number"),
        ("", "is empty"),
    ],
)
def test_a_wrong_waveform_is_refused_with_its_file(tmp_path, table, message):
    if table is not None:
        (tmp_path / "shock.csv").write_text(table)
    waveform = {"file": "shock.csv", "time": 1.0, "axis": "z", "time_unit": "s", "unit": "g"}
    path = write_scenario(tmp_path, motion={"waveforms": [{**waveform, "time_column": "t", "column": "a"}]})
    with pytest.raises(RefusedError, match=message) as refusal:
        read_scenario(path)
    assert "shock.csv" in str(refusal.value)
