"""Interruptions: what is said is true, and nothing half-written stays."""

import json
import os
import pty
import select
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from builders import make_recording
from test_cli import QUICK, run

from hgma_compensation.calibration.document import read_calibration
from hgma_compensation.cli import output_folder
from hgma_compensation.demo.processes import HGMA, private_ros_environment
from hgma_compensation.progress import counted
from hgma_compensation.recording.bag_writer import write_recording

ROOT = Path(__file__).parents[1]

SCENARIO = """
scenario: 1
seed: 1
sensor_id: long
oven: {start: 25.0, time_constant: 120.0, program: [{to: 26.0, rate: 1.0, soak: 1440.0}]}
thermistor: {rate: 1.0, noise: 0.03}
accelerometer:
  rate: 50.0
  axes: {z: {true_value: 9.8, drift_span_g: 5.0, rate_drift: 0.0, white_noise_g_per_h: 100.0}}
"""


def long_runs(folder):
    """Return the arguments of commands that last for seconds, each with the text of its first bar."""
    write_recording(make_recording(duration_s=4000.0, accel_rate=5.0, cycles=4.0), folder / "bag")
    (folder / "scenario.yaml").write_text(SCENARIO)
    time_column = np.arange(400_000) * 0.01
    np.savetxt(
        folder / "t.csv", np.column_stack([time_column] * 2), fmt="%.2f", delimiter=",", header="t,T", comments=""
    )
    out = folder / "work" / "out"
    columns = ["--time", "t", "--temperature", "T", "--linear-acceleration-z", "T"]
    return {
        "simulating": ["simulate", folder / "scenario.yaml", "-o", out],
        "reading": ["import-csv", folder / "t.csv", "-o", out, *columns],
        "linear_acceleration": ["train", folder / "bag", "-o", out],
    }


def test_a_bar_is_shown_on_a_terminal_and_an_interruption_leaves_nothing(tmp_path):
    runs = long_runs(tmp_path)
    (tmp_path / "work").mkdir()
    for bar, words in runs.items():
        master, slave = pty.openpty()
        environment = {**os.environ, "COLUMNS": "100", "TERM": "xterm"}
        process = subprocess.Popen(
            [*HGMA, *map(str, words)], stdout=subprocess.PIPE, stderr=slave, text=True, env=environment
        )
        os.close(slave)
        seen, interrupted, end = "", False, time.monotonic() + 120.0
        while process.poll() is None or select.select([master], [], [], 0.0)[0]:
            assert time.monotonic() < end, seen
            if select.select([master], [], [], 0.05)[0]:
                try:
                    seen += os.read(master, 4096).decode(errors="replace")
                except OSError:  # the other side is closed
                    break
            if bar in seen and not interrupted:
                process.send_signal(signal.SIGINT)
                interrupted = True
        os.close(master)
        # Python ends by the signal itself where it struck in code made of text, such as that of a dataclass.
        assert process.wait(60.0) in (130, -signal.SIGINT), (bar, seen)
        assert "interrupted, nothing was written" in seen
        assert "Traceback" not in seen
        assert process.stdout.read() == ""
        process.stdout.close()
        assert os.listdir(tmp_path / "work") == []


def test_what_was_written_before_is_named(tmp_path, monkeypatch, capsys):
    write_recording(make_recording(duration_s=300.0, cycles=2.0), tmp_path / "bag")

    def interrupt(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr("hgma_compensation.cli.train.write_json", interrupt)
    cal = tmp_path / "cal.json"
    assert run("train", tmp_path / "bag", "-o", cal, "--json", tmp_path / "figures.json", *QUICK) == 130
    assert f"interrupted, {cal} was written before" in capsys.readouterr().err
    assert read_calibration(cal)
    assert not (tmp_path / "figures.json").exists()
    monkeypatch.setattr("hgma_compensation.cli.inspect.read_calibration", interrupt)
    assert run("inspect", cal) == 130
    assert "interrupted, nothing was written" in capsys.readouterr().err


@pytest.mark.parametrize("there", [True, False])
def test_a_folder_is_filled_whole_or_not_at_all(tmp_path, there):
    target = tmp_path / "out"
    if there:
        target.mkdir()
        (target / "mine").write_text("kept")

    def interrupted():
        with output_folder.scratch_folder(target) as scratch:
            (scratch / "report.html").write_text("half")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert sorted(path.name for path in tmp_path.rglob("*")) == (["mine", "out"] if there else [])
    with output_folder.scratch_folder(target) as scratch:
        (scratch / "report.html").write_text("whole")
    assert (target / "report.html").read_text() == "whole"
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


@pytest.mark.parametrize(("items", "told"), [(0, []), (7, [3, 3, 1]), (6, [3, 3])])
def test_every_item_is_counted_in_the_end(items, told):
    heard = []
    assert list(counted(range(items), heard.append, every=3)) == list(range(items))
    assert heard == told


def test_items_before_an_exception_are_counted():
    heard = []

    def broken():
        yield from range(5)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        list(counted(broken(), heard.append, every=3))
    assert heard == [3, 2]


@pytest.mark.ros
def test_what_was_played_is_told_also_when_it_is_stopped(tmp_path):
    from robot import Robot  # needs rclpy
    from sensor_msgs.msg import Imu

    write_recording(make_recording(duration_s=2.0, accel_rate=10.0), tmp_path / "bag")
    environment = private_ros_environment()
    words = [*HGMA, "play", str(tmp_path / "bag"), "--json", "-"]
    whole = subprocess.run(
        [*words, "--rate", "10"], env=environment, capture_output=True, text=True, timeout=60, check=True
    )
    messages = json.loads(whole.stdout)["messages"]
    assert json.loads(whole.stdout) == {"messages": messages, "interrupted": False}
    assert f"{messages} messages played" in whole.stderr
    robot = Robot(int(environment["ROS_DOMAIN_ID"]))
    raw = robot.collect(Imu, "accel/raw")
    player = subprocess.Popen(
        [*words, "--loop", "--rate", "0.1"], env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    try:
        robot.wait(lambda: len(raw) > 0, "a sample")
        player.send_signal(signal.SIGINT)
        out, err = player.communicate(timeout=60)
    finally:
        player.kill()
        player.wait()
        robot.close()
    assert player.returncode == 0
    assert json.loads(out)["interrupted"] is True
    assert 0 < json.loads(out)["messages"] < messages
    assert "messages played, interrupted" in err


def test_an_interruption_while_the_program_loads_is_no_traceback(tmp_path):
    """A module that takes for ever to load stands for the moment in which nothing has begun."""
    (tmp_path / "click.py").write_text("import time\nprint('loading', flush=True)\ntime.sleep(60)\n")
    path = os.pathsep.join([str(tmp_path), str(ROOT)])
    process = subprocess.Popen(
        [sys.executable, "-m", "hgma_compensation.cli.entry"],
        env={**os.environ, "PYTHONPATH": path},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stdout.readline() == "loading\n"
    process.send_signal(signal.SIGINT)
    _, said = process.communicate(timeout=30.0)
    assert (process.returncode, said) == (130, "interrupted, nothing was written\n")


def test_what_the_caller_ignores_is_ignored_while_the_program_loads(tmp_path):
    (tmp_path / "click.py").write_text("import sys, time\nprint('loading', flush=True)\ntime.sleep(1)\nsys.exit(7)\n")
    path = os.pathsep.join([str(tmp_path), str(ROOT)])
    process = subprocess.Popen(
        ["sh", "-c", 'trap "" INT; exec "$0" -m hgma_compensation.cli.entry', sys.executable],
        env={**os.environ, "PYTHONPATH": path},
        stdout=subprocess.PIPE,
        text=True,
    )
    assert process.stdout.readline() == "loading\n"
    process.send_signal(signal.SIGINT)
    assert process.wait(30.0) == 7
    process.stdout.close()
