"""``hgma export`` from a calibration file to a file of parameters."""

import json

import numpy as np
import pytest
from autopilots import commas, ground_station, shell
from builders import make_calibration, make_recording

from hgma_compensation.calibration.document import write_calibration
from hgma_compensation.channels import CHANNELS
from hgma_compensation.cli.main import main
from hgma_compensation.effects.applied import AppliedEffect
from hgma_compensation.effects.registry import make
from hgma_compensation.evaluation.evaluate import evaluate
from hgma_compensation.migration.export import make_export
from hgma_compensation.migration.not_carried import not_carried
from hgma_compensation.migration.target import Format, Target
from hgma_compensation.recording.bag_reader import read_recording
from hgma_compensation.recording.bag_writer import write_recording
from hgma_compensation.recording.compensated_bag import compensate_recording
from hgma_compensation.training.blocks import group_means
from hgma_compensation.training.reference import Reference

READERS = {"px4": lambda text: ground_station(text)[0], "px4-nsh": shell, "ardupilot": commas}
EACH = pytest.mark.parametrize("name", READERS)


@pytest.fixture
def cal(tmp_path):
    write_calibration(make_calibration(2), tmp_path / "cal.json")
    return tmp_path / "cal.json"


@pytest.fixture
def bag(tmp_path):
    write_recording(make_recording(duration_s=300.0, cycles=2.0), tmp_path / "bag")
    return tmp_path / "bag"


def run(*words):
    return main([str(word) for word in words])


def refused(capsys, *words):
    assert run(*words) == 2
    error = capsys.readouterr().err
    assert error.startswith("error: ")
    assert error.count("\n") == 1
    return error


@EACH
def test_the_file_holds_what_the_figures_say(tmp_path, cal, name, capsys):
    out, figures = tmp_path / "out", tmp_path / "e.json"
    assert run("export", cal, "--format", name, "-o", out, "--instance", 1, "--json", figures) == 0
    said = json.loads(figures.read_text())
    read = READERS[name](out.read_text())
    assert {name: float(value) for name, value in read.items()} == said["parameters"]
    assert said["not_carried"] == list(not_carried(make_calibration(2), CHANNELS[:3])) != []
    shown = capsys.readouterr()
    assert "not carried: answer of the drift" in shown.out
    assert [f"warning: {line}" for line in said["warnings"]] == shown.err.splitlines()
    for figure in said["channels"].values():
        assert figure["at_rest"]["rms"] < figure["over_rates"]["rms"]
    comments = [line for line in out.read_text().splitlines() if line.startswith("#")]
    assert said["calibration_id"] in comments[0]


@EACH
def test_the_loss_on_a_recording_is_that_of_the_autopilots_formula(tmp_path, cal, bag, name):
    out, figures = tmp_path / "out", tmp_path / "e.json"
    reference = Reference.parse("9.81")
    words = ["--recording", bag, "--reference", "9.81", "--json", figures]
    assert run("export", cal, "--format", name, "-o", out, *words) == 0
    losses = json.loads(figures.read_text())["recording"]
    calibration, recording = make_calibration(2), read_recording(bag)
    offsets = make_export(calibration, Target(Format(name))).offsets()
    inputs = recording.stamps, np.interp(recording.stamps, recording.temperature.stamps, recording.temperature.values)
    corrected = recording.values[:, :3] - offsets(*inputs)
    index = ((recording.stamps - recording.stamps[0]) // (5 * 10**9)).astype(np.int64)
    errors = np.sqrt(np.mean((group_means(index, corrected) - 9.81) ** 2, axis=0))
    full = evaluate(recording, calibration, reference)
    for column, channel in enumerate(full.channels):
        loss = losses[channel.name]
        assert loss["raw"] == pytest.approx(channel.raw.rms_error, rel=1e-12)
        assert loss["full"] == pytest.approx(channel.compensated.rms_error, rel=1e-12)
        assert loss["noise_floor"] == pytest.approx(channel.noise_floor, rel=1e-12)
        # The pipeline's temperature is a trend through that of the thermistor, 0.01 °C of noise.
        assert loss["cubic"] == pytest.approx(errors[column], rel=0.02)


def test_what_comes_before_the_part_that_counts_is_history(tmp_path, bag):
    creep = make("stress_relaxation", {"time_constant": 900.0, "spread": 1.0})
    calibration = make_calibration(effects=[AppliedEffect("linear_acceleration.z", creep, np.array([0.5]))])
    write_calibration(calibration, tmp_path / "cal.json")
    words = ["--recording", bag, "--reference", "9.81", "--from", 100, "--until", 200, "--json", tmp_path / "e.json"]
    assert run("export", tmp_path / "cal.json", "--format", "px4", "-o", tmp_path / "out", *words) == 0
    losses = json.loads((tmp_path / "e.json").read_text())["recording"]
    recording = read_recording(bag)
    result = compensate_recording(recording, calibration).values
    time = (recording.stamps - recording.start) / 1e9
    counted = (time >= 100.0) & (time < 200.0)
    errors = group_means(np.floor((time[counted] - time[counted][0]) / 5.0).astype(np.int64), result[counted]) - 9.81
    for column, loss in enumerate(losses.values()):
        assert loss["full"] == pytest.approx(np.sqrt(np.mean(errors[:, column] ** 2)), rel=1e-9)


def test_a_part_of_the_channels_and_temperatures(tmp_path, cal, bag):
    out, figures = tmp_path / "out", tmp_path / "e.json"
    words = ["--channels", "linear_acceleration.y", "--range", 0, 40, "--recording", bag, "--json", figures]
    assert run("export", cal, "--format", "px4", "-o", out, *words) == 0
    said, (values, _) = json.loads(figures.read_text()), ground_station(out.read_text())
    assert list(said["channels"]) == list(said["recording"]) == ["linear_acceleration.y"]
    assert (values["TC_A0_TMIN"], values["TC_A0_TMAX"], values["TC_A0_TREF"]) == ("0.0", "40.0", "20.0")
    assert float(values["TC_A0_X1_0"]) == 0.0 != float(values["TC_A0_X1_1"])
    assert "no calibration of linear_acceleration.x, linear_acceleration.z" in said["warnings"][0]
    assert said["recording"]["linear_acceleration.y"]["cubic"] != said["recording"]["linear_acceleration.y"]["raw"]


def test_accelerometer_and_gyroscope_together(tmp_path):
    write_calibration(make_calibration(2, channels=CHANNELS), tmp_path / "cal.json")
    out = tmp_path / "out"
    words = ["--device-id", 2883594, "--gyro-device-id", 2883595, "--axes", "flu"]
    assert run("export", tmp_path / "cal.json", "--format", "px4", "-o", out, *words) == 0
    values, _ = ground_station(out.read_text())
    assert (values["TC_A0_ID"], values["TC_G0_ID"]) == ("2883594", "2883595")
    export = make_export(make_calibration(2, channels=CHANNELS), Target(Format.PX4))
    for letter, first in (("A", 0), ("G", 3)):
        for axis, sign in enumerate((1.0, -1.0, -1.0)):
            expected = np.float32(sign * export.cubics[first + axis].cubic.coefficients[1])
            assert np.float32(values[f"TC_{letter}0_X1_{axis}"]) == expected


def test_mistakes_are_one_line_and_leave_nothing(tmp_path, cal, bag, capsys):
    out = tmp_path / "out"
    export = ("export", cal, "--format", "px4", "-o", out)
    assert "--format" in refused(capsys, "export", cal, "-o", out)
    assert "betaflight" in refused(capsys, "export", cal, "--format", "betaflight", "-o", out)
    assert "exists" in refused(capsys, "export", cal, "--format", "px4", "-o", cal)
    assert "nothing.json" in refused(capsys, "export", tmp_path / "nothing.json", "--format", "px4", "-o", out)
    assert "--instance 4" in refused(capsys, *export, "--instance", 4)
    assert "does not exist" in refused(capsys, *export, "--channels", "z")
    assert "--channels angular_velocity.x: the calibration has" in refused(
        capsys, *export, "--channels", "angular_velocity.x"
    )
    assert "--range 100 120" in refused(capsys, *export, "--range", 100, 120)
    assert "--device-id 0" in refused(capsys, *export, "--device-id", 0)
    assert "does not exist" in refused(capsys, *export, "--recording", tmp_path / "no_bag")
    assert "--reference" in refused(capsys, *export, "--recording", bag, "--reference", "x")
    assert "no sample from 1000 s" in refused(capsys, *export, "--recording", bag, "--from", 1000)
    assert "--from is for the loss on a recording" in refused(capsys, *export, "--from", 5)
    assert "--reference is for" in refused(capsys, *export, "--reference", "9.81")
    assert "no directory" in refused(capsys, *export, "--json", tmp_path / "no" / "e.json")
    assert "is another file of this command" in refused(capsys, *export, "--json", out)
    ardupilot = ("export", cal, "--format", "ardupilot", "-o", out)
    assert "leave it out" in refused(capsys, *ardupilot, "--device-id", 5)
    document = json.loads(cal.read_text())
    document["effects"] = [{"effect": "moon", "channel": "linear_acceleration.x", "parameters": {}, "gains": [1.0]}]
    (tmp_path / "moon.json").write_text(json.dumps(document))
    assert "effect 'moon' is unknown" in refused(capsys, "export", tmp_path / "moon.json", "--format", "px4", "-o", out)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["bag", "cal.json", "moon.json"]


def test_effects_are_named_and_their_inputs_demanded_of_the_recording_only(tmp_path, bag, capsys):
    gradient = make("thermal_gradient", {})
    effects = [AppliedEffect("linear_acceleration.x", gradient, np.full(gradient.count, 2.0))]
    write_calibration(make_calibration(effects=effects), tmp_path / "cal.json")
    words = ("export", tmp_path / "cal.json", "--format", "ardupilot", "-o")
    assert run(*words, tmp_path / "out") == 0
    assert "(effect thermal_gradient): linear_acceleration.x" in (tmp_path / "out").read_text()
    refusal = refused_last(capsys, *words, tmp_path / "out2", "--recording", bag)
    assert "no sample on /accel/temperature_2, which the effect thermal_gradient" in refusal
    assert not (tmp_path / "out2").exists()


def refused_last(capsys, *words):
    capsys.readouterr()
    return refused(capsys, *words)
