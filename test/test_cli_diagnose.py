import json
import subprocess
from dataclasses import replace

import numpy as np
import pytest
from builders import LINEAR, make_calibration
from diagnosis_blocks import CHANNEL, LASTS, lagging_days, trained_before
from test_cli import refused
from test_cli import run as hgma

from hgma_compensation.calibration.document import read_calibration, write_calibration
from hgma_compensation.cli.diagnose import CALIBRATION, FIGURES, REPORT
from hgma_compensation.demo.processes import HGMA
from hgma_compensation.recording.bag_reader import read_recording
from hgma_compensation.recording.bag_writer import write_recording
from hgma_compensation.recording.compensated_bag import compensate_recording


@pytest.fixture(scope="module")
def days():
    names = ("first", "second", "third")
    return {name: replace(day, name=name) for name, day in zip(names, lagging_days(), strict=True)}


@pytest.fixture(scope="module")
def folder(tmp_path_factory, days):
    """Return a folder with the bags of three days and a calibration that knows nothing of the lag."""
    folder = tmp_path_factory.mktemp("diagnose")
    for name, recording in days.items():
        write_recording(recording, folder / name)
    write_calibration(trained_before(), folder / "before.json")
    return folder


def words(folder, output, *bags):
    return ["diagnose", *(folder / bag for bag in bags), "--calibration", folder / "before.json", "-o", output]


@pytest.fixture(scope="module")
def done(folder):
    """Run the command as a user does, judged on the third day."""
    arguments = [*words(folder, folder / "out", "first", "second"), "--holdout", folder / "third"]
    command = [*HGMA, *map(str, arguments), "--json", str(folder / "figures.json")]
    return subprocess.run(command, capture_output=True, text=True, timeout=200, check=False)


def test_it_says_what_it_found_and_where_it_is(done, folder):
    assert (done.returncode, done.stderr) == (0, "")
    assert f"{CHANNEL}: explained by thermal_lag" in done.stdout
    assert str(folder / "out" / REPORT) in done.stdout
    assert sorted(path.name for path in (folder / "out").iterdir()) == sorted([CALIBRATION, FIGURES, REPORT])


def test_its_figures_are_those_that_scripts_rely_on(done, folder):
    figures = json.loads((folder / "out" / FIGURES).read_text())
    assert figures["calibration"] == str(folder / "out" / CALIBRATION)
    assert list(figures["channels"]) == [CHANNEL]
    channel = figures["channels"][CHANNEL]
    assert channel["verdict"] == "explained"
    (effect,) = channel["effects"]
    assert effect["name"] == "thermal_lag"
    assert effect["parameters"]["time_constant"] == pytest.approx(45.0, rel=0.05)
    assert 0.0 <= effect["p_value"] < 0.002
    assert 0.0 < channel["noise_floor"] < channel["error_after"] < 0.5 * channel["error_before"]
    assert json.loads((folder / "figures.json").read_text()) == figures


def test_the_calibration_does_what_the_figures_say(done, folder, days):
    augmented = read_calibration(folder / "out" / CALIBRATION)
    assert [effect.effect.name for effect in augmented.effects] == ["thermal_lag"]
    channel = json.loads((folder / "out" / FIGURES).read_text())["channels"][CHANNEL]
    for calibration, error in ((read_calibration(folder / "before.json"), "before"), (augmented, "after")):
        values = compensate_recording(days["third"], calibration).values[80:, 0]
        means = values[: len(values) // 20 * 20].reshape(-1, 20).mean(axis=1) - calibration.channels[0].reference
        assert np.sqrt(np.mean(means**2)) == pytest.approx(channel[f"error_{error}"], rel=0.1)


def test_the_report_is_a_page(done, folder):
    page = (folder / "out" / REPORT).read_text(encoding="utf-8")
    assert page.lower().startswith("<!doctype html>")
    assert page.rstrip().endswith("</html>")
    assert "thermal lag" in page


def test_the_last_of_several_is_held_out_and_the_folder_may_be_there(folder, tmp_path, capsys):
    assert hgma(*words(folder, tmp_path, "third", "first", "second")) == 0
    figures = json.loads((tmp_path / FIGURES).read_text())
    assert figures["holdout"] == "third"
    assert figures["channels"][CHANNEL]["verdict"] == "explained"
    assert "thermal_lag" in capsys.readouterr().out


def test_the_same_seed_gives_the_same_files(folder, tmp_path, done):
    for name in ("a", "b"):
        arguments = [*words(folder, tmp_path / name, "first", "second"), "--holdout", folder / "third"]
        assert hgma(*arguments, "--seed", 7) == 0
    one, other = (read_calibration(tmp_path / name / CALIBRATION) for name in ("a", "b"))
    assert one.calibration_id == other.calibration_id
    figures = [json.loads((tmp_path / name / FIGURES).read_text())["channels"] for name in ("a", "b")]
    assert figures[0] == figures[1]


def test_a_bag_that_is_not_there_is_refused(folder, tmp_path, capsys):
    assert "nothing" in refused(capsys, *words(folder, tmp_path / "out", "first", "nothing"))
    assert "nothing" in refused(capsys, *words(folder, tmp_path / "out", "first"), "--holdout", tmp_path / "nothing")
    assert not (tmp_path / "out").exists()


def test_a_recording_that_is_given_twice_is_refused(folder, tmp_path, capsys):
    for arguments in (
        [*words(folder, tmp_path / "out", "first", "second"), "--holdout", folder / "second"],
        [*words(folder, tmp_path / "out", "first"), "--holdout", folder / "." / "first"],
        words(folder, tmp_path / "out", "first", "first"),
    ):
        assert "is given twice" in refused(capsys, *arguments)
    assert not (tmp_path / "out").exists()


def test_an_output_that_cannot_be_a_folder_is_refused(folder, tmp_path, capsys):
    (tmp_path / "file").write_text("mine")
    assert "is a file" in refused(capsys, *words(folder, tmp_path / "file", "first", "second"))
    assert (tmp_path / "file").read_text() == "mine"
    assert "no directory" in refused(capsys, *words(folder, tmp_path / "no" / "out", "first", "second"))
    assert not (tmp_path / "no").exists()


@pytest.mark.parametrize("single", [True, False])
def test_a_recording_that_is_too_short_is_refused(folder, days, tmp_path, capsys, single):
    short = days["second"].cut(0.0, 0.08 * LASTS)
    write_recording(short, tmp_path / "short")
    arguments = words(folder, tmp_path / "out", *([] if single else ["first"]), tmp_path / "short")
    assert "record for longer" in refused(capsys, *arguments)
    assert not (tmp_path / "out").exists()


def test_a_recording_without_a_channel_of_the_calibration_is_refused(folder, tmp_path, capsys):
    write_calibration(make_calibration(channels=LINEAR), tmp_path / "xyz.json")
    arguments = ["diagnose", folder / "first", folder / "second", "-o", tmp_path / "out"]
    refusal = refused(capsys, *arguments, "--calibration", tmp_path / "xyz.json")
    assert "no channel linear_acceleration.x, linear_acceleration.y" in refusal
    assert "nothing.json" in refused(capsys, *arguments, "--calibration", tmp_path / "nothing.json")
    assert not (tmp_path / "out").exists()


def test_an_interrupted_diagnosis_leaves_nothing(folder, tmp_path, capsys, monkeypatch):
    def interrupt(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr("hgma_compensation.diagnosis.diagnose.prepare", interrupt)
    assert hgma(*words(folder, tmp_path / "out", "first", "second")) == 130
    assert "interrupted" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_bag_is_left_as_it_was(folder, done):
    assert read_recording(folder / "first").present == (CHANNEL,)
    assert sorted(path.name for path in (folder / "first").iterdir()) == ["first.mcap", "metadata.yaml"]


def test_its_figures_go_to_standard_output_alone(folder, tmp_path, capsys):
    assert hgma(*words(folder, tmp_path / "out", "first", "second"), "--json", "-") == 0
    captured = capsys.readouterr()
    assert json.loads(captured.out) == json.loads((tmp_path / "out" / FIGURES).read_text())
    assert str(tmp_path / "out" / REPORT) in captured.err
