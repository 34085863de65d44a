"""Every command of the documents is run, in the order in which a reader would."""

import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from builders import make_calibration
from document_shell import NOT_RUN, ROOT, blocks, is_printed, outputs, run_document

from hgma_compensation.calibration.document import write_calibration
from hgma_compensation.recording.bag_reader import read_recording
from hgma_compensation.recording.bag_writer import write_recording
from hgma_compensation.recording.recording import Recording

DOCUMENTS = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]

DAYS = {
    "monday": (0.0, 4_500.0),
    "tuesday": (4_500.0, 9_300.0),
    "wednesday": (9_300.0, 14_000.0),
    "thursday": (17_100.0, None),
}
"""Parts of bags/oven_test, s: what a reader would have recorded."""

TWO_CYCLES = (0.0, 17_100.0)

UNRUN_BLOCKS = {
    "SECURITY.md": "sros2 is not on PyPI, and without its keystore the node would not start",
    "FLEET.md": "machines of a cluster: test_fleet_cluster.py has workers of its own",
}
"""Documents with a block of commands that is no ```sh block, so that it is not run."""

OWN_TEST = {"MIGRATION.md": "test_migration_document.py"}
"""Documents whose commands need the measured data, and that are compared with their figures besides."""

WITH_COMMANDS = [document for document in DOCUMENTS if blocks(document) and document.name not in OWN_TEST]


def table(path: Path, recording: Recording) -> None:
    """Write a recording as the table that a data logger would."""
    seconds = (recording.stamps - recording.stamps[0]) * 1e-9
    celsius = np.interp(recording.stamps, recording.temperature.stamps, recording.temperature.values)
    columns = np.column_stack([seconds, celsius, recording.values[:, 2]])[::2]
    np.savetxt(path, columns, delimiter=",", header="t,temp,az", comments="", fmt="%.6f")


@pytest.fixture
def folder(tmp_path):
    """What a reader has: a table of an oven test, recordings of some days, and another calibration."""
    oven_test = read_recording(ROOT / "bags" / "oven_test")
    for name, span in DAYS.items():
        write_recording(oven_test.cut(*span), tmp_path / name)
    table(tmp_path / "table.csv", oven_test.cut(*TWO_CYCLES))
    write_calibration(make_calibration(channels=("linear_acceleration.z",), seed=3), tmp_path / "other.json")
    return tmp_path


@pytest.mark.ros
@pytest.mark.slow
@pytest.mark.timeout(600)
@pytest.mark.parametrize("document", WITH_COMMANDS, ids=lambda path: path.name)
def test_commands_run_as_they_stand(document, folder):
    printed = run_document(document, folder, seconds=580.0)
    for shown in outputs(document):
        assert is_printed(shown, printed), f"{shown}\n\nis shown, printed was\n\n{printed}"


def test_what_is_shown_is_compared_word_by_word():
    printed = "a 12.0 m/s² (3.1 g)\n ────\n b -5 c"
    assert is_printed("12.1 m/s² (3.1 g) b", printed)
    assert not is_printed("13.1 m/s² (3.1 g) b", printed)
    assert not is_printed("12.0 m/s²  b", printed)
    assert not is_printed("b 5 c", printed)


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_blocks_of_commands_are_marked_as_such(document):
    for language, text in re.findall(r"^```(\w*)\n(.*?)^```", document.read_text(encoding="utf-8"), re.M | re.S):
        if re.search(r"^\s*(hgma|make|ros2|python|colcon) ", text, re.MULTILINE) and document.name not in UNRUN_BLOCKS:
            assert language == "sh", text


def test_what_is_not_run_is_not_there():
    for beginning in NOT_RUN:
        program = beginning.split()[0]
        assert program in ("git",) or shutil.which(program) is None, f"{program} is there: run its commands"
