import json
import os

import numpy as np
import pytest
from builders import make_calibration, make_recording

from hgma_compensation.calibration.document import read_calibration, write_calibration
from hgma_compensation.cli.main import COMMANDS, main
from hgma_compensation.effects.applied import AppliedEffect
from hgma_compensation.effects.registry import make
from hgma_compensation.recording.bag_reader import read_recording
from hgma_compensation.recording.bag_writer import write_recording

QUICK = ["--generations", "5", "--population", "10", "--centres", "3", "--delay", "10"]


@pytest.fixture
def bag(tmp_path):
    write_recording(make_recording(duration_s=300.0, cycles=2.0), tmp_path / "bag")
    return tmp_path / "bag"


@pytest.fixture
def calibration_file(tmp_path):
    write_calibration(make_calibration(), tmp_path / "cal.json")
    return tmp_path / "cal.json"


def run(*words):
    return main([str(word) for word in words])


def refused(capsys, *words):
    assert run(*words) == 2
    captured = capsys.readouterr()
    assert captured.err.startswith("error: ")
    assert captured.err.count("\n") == 1
    assert "Traceback" not in captured.err
    return captured.err


def test_from_a_table_to_a_figure(tmp_path, capsys):
    recording = make_recording(seed=8, duration_s=400.0, cycles=2.0)
    seconds = (recording.stamps - recording.stamps[0]) / 1e9
    temperature = np.interp(recording.stamps, recording.temperature.stamps, recording.temperature.values)
    columns = np.column_stack([seconds, temperature, recording.values[:, 2]])
    np.savetxt(tmp_path / "table.csv", columns, delimiter=",", header="t,T,az", comments="")
    bag, cal, out = tmp_path / "bag", tmp_path / "cal.json", tmp_path / "out"
    names = ["--time", "t", "--temperature", "T", "--linear-acceleration-z", "az"]
    assert run("import-csv", tmp_path / "table.csv", "-o", bag, *names) == 0
    assert run("train", bag, "-o", cal, "--reference", "9.81", "--json", tmp_path / "train.json", *QUICK) == 0
    assert run("evaluate", bag, "--calibration", cal, "--reference", "9.81", "--json", tmp_path / "e.json") == 0
    assert run("compensate", bag, "--calibration", cal, "-o", out, "--json", tmp_path / "c.json") == 0
    assert run("inspect", cal, "--json", tmp_path / "i.json") == 0
    train, evaluation, compensation, inspection = (
        json.loads((tmp_path / f"{name}.json").read_text()) for name in ("train", "e", "c", "i")
    )
    identity = read_calibration(cal).calibration_id
    assert {figures["calibration_id"] for figures in (train, evaluation, compensation, inspection)} == {identity}
    z = evaluation["channels"]["linear_acceleration.z"]
    assert z["compensated"]["rms_error"] < 0.2 * z["raw"]["rms_error"]
    assert compensation["compensated"] == compensation["samples"] == z["raw"]["samples"] == len(seconds)
    assert identity in capsys.readouterr().out
    assert read_recording(out).present == ("linear_acceleration.z",)


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_explains_itself(command, capsys):
    assert run(command, "--help") == 0
    assert "Usage: hgma" in capsys.readouterr().out


def test_alone_it_says_what_there_is(capsys):
    assert run() == 0
    output = capsys.readouterr().out
    assert all(command in output for command in COMMANDS)


def test_a_plot_is_drawn(tmp_path, bag, calibration_file):
    assert run("evaluate", bag, "--calibration", calibration_file, "--plot", tmp_path / "plot.png") == 0
    assert (tmp_path / "plot.png").read_bytes().startswith(b"\x89PNG")


def test_a_part_of_a_recording_can_be_used(tmp_path, bag, calibration_file):
    figures = tmp_path / "e.json"
    arguments = ["--calibration", calibration_file, "--from", "100", "--until", "150", "--json", figures]
    assert run("evaluate", bag, *arguments) == 0
    assert json.loads(figures.read_text())["channels"]["linear_acceleration.x"]["raw"]["samples"] == 50 * 20


def test_a_bag_can_be_written_as_sqlite(tmp_path, bag, calibration_file):
    arguments = ["--calibration", calibration_file, "--storage", "sqlite3"]
    assert run("compensate", bag, "-o", tmp_path / "out", *arguments) == 0
    assert (tmp_path / "out" / "out.db3").exists()
    assert len(read_recording(tmp_path / "out").stamps) == 6000


def test_effects_are_shown_in_words_and_their_inputs_demanded(tmp_path, bag, capsys):
    creep = make("stress_relaxation", {"time_constant": 900.0, "spread": 3.0})
    gradient = make("thermal_gradient", {})
    effects = [
        AppliedEffect("linear_acceleration.z", creep, np.array([0.5, 0.25, -0.125])),
        AppliedEffect("linear_acceleration.x", gradient, np.full(gradient.count, 2.0)),
    ]
    cal = tmp_path / "effects.json"
    write_calibration(make_calibration(effects=effects), cal)
    assert run("inspect", cal, "--json", tmp_path / "i.json") == 0
    shown = capsys.readouterr().out
    assert "linear_acceleration.z: stress relaxation" in shown
    assert "time_constant 900 s, spread 3); gains 0.5000, 0.2500, -0.1250 m/s²/°C" in shown
    assert json.loads((tmp_path / "i.json").read_text())["effects"][0]["gains"] == [0.5, 0.25, -0.125]
    for command, more in (("evaluate", []), ("compensate", ["-o", tmp_path / "out"])):
        refusal = refused(capsys, command, bag, "--calibration", cal, *more)
        assert "no sample on /accel/temperature_2, which the effect thermal_gradient" in refusal
        assert "--remap /accel/temperature_2:=" in refusal
    assert not (tmp_path / "out").exists()


def test_mistakes_are_one_line_with_exit_code_two(tmp_path, bag, calibration_file, capsys):
    cal, out = calibration_file, tmp_path / "out"
    assert "no such command" in refused(capsys, "calibrate").lower()
    assert "Missing argument" in refused(capsys, "train", "-o", out)
    assert "nothing.json" in refused(capsys, "inspect", tmp_path / "nothing.json")
    assert "does not exist" in refused(capsys, "evaluate", tmp_path / "no_bag", "--calibration", cal)
    assert "channel 'z' does not exist" in refused(capsys, "train", bag, "-o", out, "--channels", "z")
    assert "--reference" in refused(capsys, "train", bag, "-o", out, "--reference", "x")
    assert "2 numbers" in refused(capsys, "evaluate", bag, "--calibration", cal, "--reference", "1,2")
    assert "no sample from 1000 s" in refused(capsys, "train", bag, "-o", out, "--from", "1000")
    assert "exists" in refused(capsys, "compensate", bag, "--calibration", cal, "-o", bag)
    assert "no directory" in refused(capsys, "train", bag, "-o", tmp_path / "no" / "cal.json")
    assert "is a directory" in refused(capsys, "train", bag, "-o", bag)
    assert "--remap" in refused(capsys, "evaluate", bag, "--calibration", cal, "--remap", "x")
    assert "scenario" in refused(capsys, "simulate", cal, "-o", out)
    assert "is not UTF-8" in refused(capsys, "inspect", bag / "bag.mcap")
    assert not out.exists()


def test_an_interrupted_training_leaves_the_old_calibration(bag, calibration_file, monkeypatch, capsys):
    before = calibration_file.read_bytes()

    def interrupt(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr("hgma_compensation.training.methods.search_network", interrupt)
    assert run("train", bag, "-o", calibration_file) == 130
    assert "interrupted" in capsys.readouterr().err
    assert calibration_file.read_bytes() == before
    assert sorted(os.listdir(calibration_file.parent)) == ["bag", "cal.json"]
