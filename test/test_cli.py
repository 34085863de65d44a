import json
import os

import numpy as np
import pytest
from builders import make_calibration, make_recording
from cli_runs import refused, run

from hgma_compensation.calibration.document import read_calibration, write_calibration
from hgma_compensation.cli.main import COMMANDS
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
    assert "--sensor-id has 201 characters" in refused(capsys, "train", bag, "-o", out, "--sensor-id", 201 * "a")
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


def test_a_refusal_names_the_remedy(tmp_path, bag, calibration_file, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "table.csv").write_text("t,T,az\n0,20,9.8\n1,20,9.8\n")
    (tmp_path / "diagnosis").mkdir()
    (tmp_path / "diagnosis" / "calibration.json").write_bytes(calibration_file.read_bytes())
    columns = ["--temperature", "T", "--linear-acceleration-z", "az"]
    for words, remedies in (
        (["trian", "x"], ["No such command 'trian'", "did you mean train?"]),
        (["xyz"], ["there are simulate, import-csv"]),
        (["evaluate", "bag", "--calibratio", "cal.json"], ["--calibration", "hgma evaluate --help"]),
        (["evaluate", "bag"], ["add --calibration CAL (Calibration file of hgma train)"]),
        (["evaluate", "gab", "--calibration", "cal.json"], ["bag gab does not exist", "here is bag"]),
        (["evaluate", "cal.json", "--calibration", "cal.json"], ["cal.json is no recording", "rosbag2 folder"]),
        (["train", "table.csv", "-o", "x.json"], ["table.csv is a table", "hgma import-csv table.csv"]),
        (["train", ".", "-o", "x.json"], ["give a recording in it", "bag"]),
        (["inspect", "diagnosis"], ["is a folder: give diagnosis/calibration.json"]),
        (["inspect", "bag"], ["is a folder", "hgma train; here is cal.json"]),
        (["inspect", "lac.json"], ["lac.json does not exist", "here is cal.json, diagnosis/calibration.json"]),
        (["simulate", "no.yaml", "-o", "x"], ["no.yaml does not exist", "params/oven_test.yaml"]),
        (["import-csv", "no.csv", "-o", "x", "--time", "t", *columns], ["no.csv does not exist", "here is table.csv"]),
        (["import-csv", "table.csv", "-o", "x", "--time", "z", *columns], ["no column 'z'", "t, T, az"]),
        (["train", "bag", "-o", "x.json", "--method", "r"], ["rbf-ga", "polynomial-rate", "hgma train --help"]),
    ):
        refusal = refused(capsys, *words)
        assert all(remedy in refusal for remedy in remedies), refusal
    assert not (tmp_path / "x.json").exists()
    assert not (tmp_path / "x").exists()


@pytest.mark.parametrize("command", ["train", "evaluate", "compensate", "diagnose"])
def test_topics_of_another_name_are_refused_with_the_option_that_tells_them(
    tmp_path, bag, calibration_file, command, capsys
):
    """A bag whose metadata say that its thermistor has another name."""
    metadata = bag / "metadata.yaml"
    text = metadata.read_text()
    metadata.write_text(text.replace("/accel/temperature", "/imu/temp").replace("/accel/raw", "/imu/data_raw"))
    more = [] if command == "train" else ["--calibration", calibration_file]
    output = [] if command == "evaluate" else ["-o", tmp_path / "out"]
    first = refused(capsys, command, bag, *more, *output)
    assert "only /imu/data_raw, /imu/temp: add --remap /accel/raw:=/imu/data_raw" in first
    second = refused(capsys, command, bag, *more, *output, "--remap", "/accel/raw:=/imu/data_raw")
    assert "add --remap /accel/temperature:=/imu/temp" in second
    assert not (tmp_path / "out").exists()


def test_a_full_disk_is_a_line_too(bag, calibration_file, capsys, monkeypatch):
    def full(*_, **__):
        raise OSError(28, "No space left on device", "somewhere")

    monkeypatch.setattr("hgma_compensation.cli.evaluate.evaluate_bag", full)
    refusal = refused(capsys, "evaluate", bag, "--calibration", calibration_file)
    assert "somewhere: No space left on device" in refusal


def test_a_recording_that_is_given_twice_is_refused(tmp_path, bag, capsys):
    refusal = refused(capsys, "train", bag, tmp_path / "." / "bag", "-o", tmp_path / "cal2.json")
    assert "is given twice" in refusal
    assert not (tmp_path / "cal2.json").exists()


@pytest.mark.parametrize("option", ["--json", "--plot"])
def test_what_is_no_regular_file_is_never_replaced(tmp_path, bag, calibration_file, option, capsys):
    """Such as /dev/null, which a rename of root would turn into a file."""
    os.mkfifo(tmp_path / "pipe")
    refusal = refused(capsys, "evaluate", bag, "--calibration", calibration_file, option, tmp_path / "pipe")
    assert "a device or a pipe: give the name of a file" in refusal
    assert (tmp_path / "pipe").is_fifo()
    assert "for standard output" in refused(capsys, "train", bag, "-o", "-")
