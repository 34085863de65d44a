"""docs/MIGRATION.md: its commands run, and its example says what they say."""

import json
import re
import shlex
from pathlib import Path

import numpy as np
import pytest
from builders import make_calibration
from document_shell import is_printed
from test_import_presets import ardupilot_table, px4_table

from hgma_compensation.calibration.document import write_calibration
from hgma_compensation.cli.main import main
from hgma_compensation.measured_data import VARIABLE, chamber_table

TEXT = (Path(__file__).parents[1] / "docs" / "MIGRATION.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```sh\n(.*?)```", TEXT, re.DOTALL)
INLINE = [c for c in re.findall(r"`(hgma (?:import-csv|export)[^`]*)`", TEXT) if " -o " in c]
RECORDING = chamber_table()


SHOWN = re.search(r"^```text\n(.*?)^```", TEXT, re.DOTALL | re.MULTILINE).group(1)
SHOWING = 3
"""Number of the command that prints it."""


def without_id(text):
    return re.sub(r"sha256-[0-9a-f]{16}", "ID", text)


def words(command):
    """Return the arguments of a command, its placeholder filled in."""
    program, *arguments = shlex.split(command)
    assert program == "hgma"
    return ["2883594" if argument == "ID" else argument for argument in arguments]


def test_there_are_commands_to_run():
    assert len(INLINE) == 4
    assert [len(block.splitlines()) for block in BLOCKS] == [5, 5]


@pytest.mark.parametrize("command", INLINE)
def test_commands_in_the_text_run(tmp_path, monkeypatch, command):
    monkeypatch.chdir(tmp_path)
    px4_table(tmp_path / "log_sensor_accel_0.csv", rows=20)
    ardupilot_table(tmp_path / "imu.csv", rows=20)
    write_calibration(make_calibration(), tmp_path / "cal.json")
    assert main(words(command)) == 0


def rows_of_the_table():
    """Return the figures (3,) of each row of the last table."""
    rows = re.findall(r"^\| \**([^|*]+?)\**((?: \| \**[\d.]+\**){3}) \|$", TEXT, re.MULTILINE)
    return {name: np.array([float(x) for x in re.findall(r"[\d.]+", cells)]) for name, cells in rows}


@pytest.mark.slow
@pytest.mark.timeout(900)
@pytest.mark.skipif(RECORDING is None, reason=f"no measured data: set {VARIABLE} to its folder")
def test_the_example_says_what_its_commands_say(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "chamber_imu.csv").symlink_to(RECORDING.resolve())
    found = {}
    for number, command in enumerate("".join(BLOCKS).splitlines()):
        arguments = words(command)
        assert main([*arguments, "--json", f"{number}.json"]) == 0, command
        printed = capsys.readouterr().out
        if number == SHOWING:
            assert is_printed(without_id(SHOWN), without_id(printed)), printed
        losses = json.loads((tmp_path / f"{number}.json").read_text()).get("recording")
        if losses:
            found[arguments[1]] = {k: np.array([loss[k] for loss in losses.values()]) for k in ("raw", "cubic", "full")}
    table = rows_of_the_table()
    plain, full, memories = found["plain.json"], found["cal.json"], found["diagnosis/calibration.json"]
    np.testing.assert_allclose(table["raw"], plain["raw"], atol=6e-5)
    np.testing.assert_allclose(table["cubic fitted to the data, PX4"], plain["cubic"], atol=6e-5)
    np.testing.assert_allclose(table["cubic fitted to the data, ArduPilot"], plain["full"], atol=6e-5)
    # What is trained differs in its last digits between machines.
    np.testing.assert_allclose(table["cubic out of the full model, PX4"], full["cubic"], rtol=0.1)
    np.testing.assert_allclose(table["full model"], full["full"], rtol=0.1)
    np.testing.assert_allclose(table["cubic out of the model with memories, PX4"], memories["cubic"], rtol=0.1)
    np.testing.assert_allclose(table["full model with memories"], memories["full"], rtol=0.1)
    assert (full["cubic"] < 0.75 * plain["cubic"]).all()
    assert memories["full"][1] < 0.1 * full["cubic"][1]
