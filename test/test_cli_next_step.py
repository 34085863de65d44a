import json
import os
import shlex

import numpy as np
import pytest
from builders import make_calibration, make_recording
from fleet_folders import write_small_fleet
from test_cli import QUICK, run

from hgma_compensation.calibration.document import write_calibration
from hgma_compensation.cli import folder
from hgma_compensation.cli.fleet import INCOMPLETE
from hgma_compensation.cli.folder import CalibrationHere, Here, RecordingHere, TableHere, Topic, look
from hgma_compensation.cli.main import COMMANDS
from hgma_compensation.cli.next_step import lines, steps
from hgma_compensation.fleet.run import SUMMARY_JSON, SUMMARY_PAGE
from hgma_compensation.recording.bag_writer import write_recording

RUNNABLE = {"simulate", "import-csv", "plan", "check", "train", "evaluate", "compensate", "inspect", "export"}
"""Commands that end by themselves and need no longer recording than the tests make; diagnose has test_cli_diagnose."""


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def printed(capsys):
    capsys.readouterr()
    assert run() == 0
    return capsys.readouterr().out


def suggested(text):
    """Return the words of the commands that are printed."""
    return [shlex.split(line) for line in text.splitlines() if line.startswith("    ")]


def write_bag(path, **settings):
    write_recording(make_recording(duration_s=300.0, cycles=2.0, **settings), path)


def write_table(path, header):
    recording = make_recording(seed=8, duration_s=400.0, cycles=2.0)
    seconds = (recording.stamps - recording.stamps[0]) / 1e9
    temperature = np.interp(recording.stamps, recording.temperature.stamps, recording.temperature.values)
    columns = np.column_stack([seconds, temperature, recording.values[:, 2]])
    np.savetxt(path, columns, delimiter=",", header=header, comments="")


def test_an_empty_folder_gets_the_ways_to_begin(here, capsys):
    text = printed(capsys)
    commands = suggested(text)
    assert [words[:2] for words in commands] == [
        ["hgma", "simulate"],
        ["hgma", "plan"],
        ["ros2", "bag"],
        ["hgma", "import-csv"],
    ]
    assert os.path.exists(commands[0][2])
    assert run(*commands[1][1:]) == 0
    assert "/accel/raw" in commands[2]


def test_what_it_says_leads_from_a_table_to_a_compensated_recording(here, capsys):
    write_table(here / "my oven.csv", "Time [s],T,az")
    done = []
    for _ in range(10):
        todo = [w for w in suggested(printed(capsys)) if w[0] == "hgma" and w[1] in RUNNABLE - {"simulate"} - set(done)]
        if not todo:
            break
        words = todo[0][1:]
        assert run(*words, *(QUICK if words[0] == "train" else [])) == 0
        done.append(words[0])
    assert done == ["import-csv", "check", "train", "evaluate", "compensate", "inspect", "export"]
    assert {"my oven", "my oven_compensated", "calibration.json", "imu.params"} <= set(os.listdir())


@pytest.mark.parametrize("name", ["-table", "it's", "a;b", "ü$HOME"])
def test_names_of_any_kind_are_quoted(here, capsys, name):
    write_bag(here / name)
    write_calibration(make_calibration(), here / f"{name}.json")
    commands = [words for words in suggested(printed(capsys)) if words[1] in RUNNABLE]
    assert {words[1] for words in commands} == {"evaluate", "compensate", "inspect", "export"}
    for words in commands:
        assert run(*words[1:]) == 0


def test_a_recording_and_a_calibration_are_brought_together(here, capsys):
    write_bag(here / "oven")
    write_calibration(make_calibration(), here / "cal.json")
    commands = {words[1]: words for words in suggested(printed(capsys))}
    assert list(commands)[:3] == ["evaluate", "diagnose", "compensate"]
    assert commands["diagnose"][2:] == ["oven", "--calibration", "cal.json", "-o", "diagnosis"]
    assert commands["node"][2:] == ["--ros-args", "-p", "calibration_file:=cal.json"]


def test_topics_of_another_name_are_remapped():
    imu = Topic("/imu/data_raw", "sensor_msgs/msg/Imu", 6000)
    other = Topic("/other/imu", "sensor_msgs/msg/Imu", 60)
    temperature = Topic("/imu/temp", "sensor_msgs/msg/Temperature", 300)
    found = Here(recordings=[RecordingHere(folder.Path("oven"), (other, imu, temperature), 300.0)])
    (train,) = [step for step in steps(found, COMMANDS) if step.words[1] == "train"]
    assert train.words[-4:] == (
        "--remap",
        "/accel/raw:=/imu/data_raw",
        "--remap",
        "/accel/temperature:=/imu/temp",
    )


def test_a_recording_that_cannot_teach_says_why():
    imu = Topic("/accel/raw", "sensor_msgs/msg/Imu", 6000)
    short = Topic("/accel/temperature", "sensor_msgs/msg/Temperature", 10)
    cases = {(imu,): "sensor_msgs/Temperature", (short,): "sensor_msgs/Imu", (imu, short): "fewer than 50"}
    for topics, reason in cases.items():
        found = Here(recordings=[RecordingHere(folder.Path("one"), topics, 2.0)])
        assert reason in "\n".join(lines(found, COMMANDS))
        assert not [step for step in steps(found, COMMANDS) if step.words[1] == "train"]


def test_the_longest_is_trained_on_and_the_next_judges():
    topics = (
        Topic("/accel/raw", "sensor_msgs/msg/Imu", 6000),
        Topic("/accel/temperature", "sensor_msgs/msg/Temperature", 600),
    )
    bags = [RecordingHere(folder.Path(name), topics, lasts) for name, lasts in (("a", 10.0), ("b", 30.0), ("c", 20.0))]
    train = next(s for s in steps(Here(recordings=bags), COMMANDS) if s.words[1] == "train")
    assert train.words[2] == "b"
    cal = CalibrationHere(folder.Path("cal.json"), "sha256-0123456789abcdef")
    evaluate = steps(Here(recordings=bags, calibrations=[cal]), COMMANDS)[0]
    assert evaluate.words[:3] == ("hgma", "evaluate", "c")


def test_a_fleet_is_calibrated_and_its_summary_found(here, capsys):
    write_small_fleet(here / "sensors", 3)
    words = suggested(printed(capsys))[0]
    assert words == ["hgma", "fleet", "sensors", "-o", "calibrated"]
    assert run(*words[1:], *QUICK) == INCOMPLETE  # one has no thermistor
    text = printed(capsys)
    assert "Fleet's summary: calibrated/summary.html" in text
    assert suggested(text) == [words]
    assert (folder.SUMMARY_JSON, folder.SUMMARY_PAGE) == (SUMMARY_JSON, SUMMARY_PAGE)


def test_recordings_of_some_days_are_no_fleet(here, capsys):
    (here / "bags").mkdir()
    for day in ("day1", "day2"):
        write_bag(here / "bags" / day)
    assert {words[1] for words in suggested(printed(capsys))} == {"check", "train"}


def test_a_node_is_watched_and_moved_from(here, capsys):
    write_calibration(make_calibration(), here / "cal.json")
    assert [words[1] for words in suggested(printed(capsys))] == ["inspect", "node", "watch", "export"]


def test_only_commands_that_there_are_are_named():
    table = TableHere(folder.Path("t.csv"), ("t", "T", "az"))
    assert [s.words[:2] for s in steps(Here(tables=[table]), ["train"])] == []


def test_what_a_diagnosis_has_added_is_used(here):
    (here / "diagnosis").mkdir()
    write_calibration(make_calibration(), here / "cal.json")
    write_calibration(make_calibration(), here / "diagnosis" / "calibration.json")
    (here / "diagnosis" / "diagnosis.json").write_text("{}")
    write_bag(here / "oven")
    evaluate = steps(look(), COMMANDS)[0]
    assert evaluate.words[:5] == ("hgma", "evaluate", "oven", "--calibration", "diagnosis/calibration.json")
    assert not [step for step in steps(look(), COMMANDS) if step.words[1] == "diagnose"]


def test_looking_is_bounded_and_survives_what_is_no_file(here, monkeypatch):
    opened = []
    monkeypatch.setattr(folder, "_head", lambda path, length=0: opened.append(path) or "")
    for number in range(2 * folder.MOST_HERE):
        (here / f"{number}.csv").write_text("t,T\n")
    for number in range(10):
        (here / "sub" / str(number)).mkdir(parents=True)
        (here / "sub" / str(number) / "deep.csv").write_text("t,T\n")
    look()
    assert 0 < len(opened) <= folder.MOST_FILES
    assert not [path for path in opened if path.name == "deep.csv"]


def test_a_pipe_a_loop_and_damaged_files_are_passed_over(here):
    os.mkfifo(here / "pipe.csv")
    os.mkfifo(here / "pipe.json")
    os.symlink("loop.csv", here / "loop.csv")
    (here / "bytes.json").write_bytes(b"\xff\x00" * 9000)
    (here / "bag").mkdir()
    (here / "bag" / "metadata.yaml").write_text("rosbag2_bagfile_information:\n  topics_with_message_count:\n  - \n")
    (here / "cut").mkdir()
    (here / "cut" / "cut_0.mcap").write_bytes(b"")
    found = look()
    assert (found.tables, found.calibrations) == ([], [])
    assert [one.path.name for one in found.recordings] == ["bag"]
    assert [path.name for path in found.unfinished] == ["cut"]
    assert steps(found, COMMANDS)[0].words == ("ros2", "bag", "reindex", "cut")


def test_metadata_as_ros2_writes_them(here):
    """As rosbag2 of Jazzy writes it: the topic before its count, profiles as a list of their own."""
    (here / "bag").mkdir()
    topic = """    - topic_metadata:
        name: {}
        type: sensor_msgs/msg/{}
        serialization_format: cdr
        offered_qos_profiles:
          - history: keep_last
            depth: 10
        type_description_hash: RIHS01_7d
      message_count: {}
"""
    (here / "bag" / "metadata.yaml").write_text(
        "rosbag2_bagfile_information:\n  version: 9\n  storage_identifier: mcap\n  duration:\n"
        "    nanoseconds: 61000000000\n  topics_with_message_count:\n"
        + topic.format("/imu", "Imu", 6100)
        + topic.format("/temp", "Temperature", 61)
    )
    (bag,) = look().recordings
    assert bag.duration == 61.0
    assert bag.topics == (
        Topic("/imu", "sensor_msgs/msg/Imu", 6100),
        Topic("/temp", "sensor_msgs/msg/Temperature", 61),
    )


def test_the_metadata_of_our_own_bags_are_read(here):
    write_bag(here / "bag")
    (bag,) = look().recordings
    stored = json.dumps([(topic.name, topic.messages) for topic in bag.topics])
    recording = make_recording(duration_s=300.0, cycles=2.0)
    assert ["/accel/raw", len(recording.stamps)] in json.loads(stored)
    assert ["/accel/temperature", len(recording.temperature.stamps)] in json.loads(stored)
