"""What holds for every command in the table, also for those that come."""

import json
import re
import shlex
from pathlib import Path

import numpy as np
import pytest
from builders import make_calibration, make_recording
from test_cli import QUICK, refused, run

from hgma_compensation.calibration.document import read_calibration, write_calibration
from hgma_compensation.cli.main import COMMANDS, WITHOUT_JSON, load
from hgma_compensation.quantities import count, duration, quantity
from hgma_compensation.recording.bag_reader import read_recording
from hgma_compensation.recording.bag_writer import write_recording

EACH = pytest.mark.parametrize("command", COMMANDS)
SCENARIO = """
scenario: 1
seed: 1
sensor_id: short
oven: {start: 25.0, time_constant: 120.0, program: [{to: 26.0, rate: 1.0, soak: 1.0}]}
thermistor: {rate: 1.0, noise: 0.03}
accelerometer: {rate: 2.0, axes: {z: {true_value: 9.8, drift_span_g: 5.0, rate_drift: 0.0, white_noise_g_per_h: 100.0}}}
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("commands")
    write_recording(make_recording(duration_s=300.0, cycles=2.0), folder / "bag")
    write_calibration(make_calibration(), folder / "cal.json")
    table = np.column_stack([np.arange(100.0), np.linspace(20.0, 30.0, 100), np.full(100, 9.81)])
    np.savetxt(folder / "table.csv", table, delimiter=",", header="t,T,az", comments="")
    (folder / "scenario.yaml").write_text(SCENARIO)
    return folder


def words(folder, output, command):
    """Return the arguments of a run of a command whose output, if any, is new."""
    bag, cal = folder / "bag", folder / "cal.json"
    columns = ["--time", "t", "--temperature", "T", "--linear-acceleration-z", "az"]
    return {
        "simulate": [folder / "scenario.yaml", "-o", output],
        "import-csv": [folder / "table.csv", "-o", output, *columns],
        "train": [bag, "-o", output, *QUICK],
        "evaluate": [bag, "--calibration", cal],
        "compensate": [bag, "--calibration", cal, "-o", output],
        "inspect": [cal],
    }[command]


@EACH
def test_its_help_has_an_example_that_can_be_parsed(command, capsys):
    assert run(command, "--help") == 0
    text = re.sub(r"\s+", " ", capsys.readouterr().out)
    example = re.search(rf"Example: hgma ({command}(?: .*)?)$", text)
    assert example, f"add epilog='Example: hgma {command} ...' to the command"
    tokens = shlex.split(example.group(1))[1:]
    load(command).make_context(command, tokens, resilient_parsing=True)
    options = {name for parameter in load(command).params for name in (*parameter.opts, *parameter.secondary_opts)}
    if command != "node":
        assert {token for token in tokens if token.startswith("-")} <= options


@EACH
def test_it_has_json_or_a_reason_why_not(command):
    options = {name for parameter in load(command).params for name in parameter.opts}
    assert ("--json" in options) != (command in WITHOUT_JSON)


@pytest.mark.parametrize("command", ["simulate", "import-csv", "train", "evaluate", "compensate", "inspect"])
def test_standard_output_holds_nothing_but_the_figures(command, folder, tmp_path, capsys):
    shown, filed, piped = (tmp_path / name for name in ("shown", "filed", "piped"))
    assert run(command, *words(folder, shown, command)) == 0
    text = capsys.readouterr()
    assert text.out
    assert run(command, *words(folder, filed, command), "--json", tmp_path / "figures.json") == 0
    assert capsys.readouterr().out.replace("filed", "shown") == text.out
    assert run(command, *words(folder, piped, command), "--json", "-") == 0
    captured = capsys.readouterr()
    assert json.loads(captured.out) == json.loads((tmp_path / "figures.json").read_text())
    assert captured.err.replace("piped", "shown") == text.out


def test_figures_are_those_that_are_shown(folder, tmp_path, capsys):
    bag = read_recording(folder / "bag")

    def both(command):
        assert run(command, *words(folder, tmp_path / command, command), "--json", tmp_path / "figures.json") == 0
        return json.loads((tmp_path / "figures.json").read_text()), capsys.readouterr().out

    for command, samples in (("simulate", None), ("import-csv", 100)):
        figures, text = both(command)
        assert samples in (None, figures["samples"])
        assert f"{count(figures['samples'])} samples over {duration(figures['duration'])}" in text
        assert text.rstrip().endswith(f"of {', '.join(figures['channels'])}")
    figures, text = both("train")
    assert figures["calibration_id"] == read_calibration(tmp_path / "train").calibration_id
    assert all(figures[name] in text for name in ("calibration_id", "sensor_id", "folds"))
    for channel in figures["channels"].values():
        for figure in ("fit", "cross_validated", "noise"):
            assert quantity(channel[figure], channel["unit"]) in text
    figures, text = both("evaluate")
    for channel in figures["channels"].values():
        for measures in (channel["raw"], channel["compensated"]):
            assert measures["samples"] == len(bag.stamps)
            assert quantity(measures["rms_error"], channel["unit"]) in text
            assert quantity(measures["span"], channel["unit"]) in text
            assert quantity(measures["velocity_random_walk"], channel["unit"] + "/√Hz") in text
            assert quantity(measures["bias_instability"], channel["unit"]) in text
        assert quantity(channel["noise_floor"], channel["unit"]) in text
    figures, text = both("compensate")
    for figure in ("samples", "compensated", "outside_calibrated_range"):
        assert count(figures[figure]) in text
    figures, text = both("inspect")
    assert figures["calibration_id"] in text
    for name, unit in (("temperature", "°C"), ("temperature_rate", "°C/s"), ("temperature_product", "°C^2")):
        assert all(quantity(limit, unit) in text for limit in figures["calibrated_range"][name])


def test_figures_never_replace_another_file_of_the_command(folder, tmp_path, capsys):
    before = (folder / "cal.json").read_bytes()
    arguments = [folder / "bag", "--calibration", folder / "cal.json"]
    for command, more, place in (
        ("evaluate", [], folder / "cal.json"),
        ("compensate", ["-o", tmp_path / "out"], tmp_path / "out"),
    ):
        refusal = refused(capsys, command, *arguments, *more, "--json", place)
        assert "--json" in refusal
        assert "a name of its own" in refusal
    assert (folder / "cal.json").read_bytes() == before
    assert not (tmp_path / "out").exists()


def test_a_place_for_figures_that_is_none_is_refused_before_any_work(folder, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("hgma_compensation.cli.train.open_recording", None)
    arguments = [folder / "bag", "-o", tmp_path / "cal.json", "--json"]
    assert "no directory" in refused(capsys, "train", *arguments, tmp_path / "no" / "figures.json")
    assert "is a directory" in refused(capsys, "train", *arguments, tmp_path)


def test_a_refusal_leaves_standard_output_empty(tmp_path, capsys):
    assert run("inspect", tmp_path / "nothing.json", "--json", "-") == 2
    assert capsys.readouterr().out == ""


REFERENCE = (Path(__file__).parents[1] / "docs" / "REFERENCE.md").read_text(encoding="utf-8")


@EACH
def test_it_stands_in_the_table_of_commands(command):
    section = REFERENCE.partition("\n## Commands\n")[2].partition("\n## ")[0]
    assert re.search(rf"^\| `hgma {command}\b", section, re.MULTILINE)


@pytest.mark.parametrize("command", ["simulate", "import-csv", "train", "evaluate", "compensate"])
def test_its_figures_are_documented(command, folder, tmp_path, capsys):
    section = REFERENCE.partition("\n### JSON\n")[2].partition("\n### ")[0]
    (row,) = [row for row in section.splitlines() if re.match(rf"\| ([\w-]+, )*{command}\b", row)]
    assert run(command, *words(folder, tmp_path / "out", command), "--json", "-") == 0
    figures = json.loads(capsys.readouterr().out)

    def keys(value):
        for name, inner in value.items() if isinstance(value, dict) else ():
            yield from keys(inner)
            if not name.startswith(("linear_", "angular_")):
                yield name

    assert set(keys(figures)) == {name.removesuffix(".<name>") for name in re.findall(r"`([\w.<>]+)`", row)}
