"""How the node's process starts and ends: arguments that are refused, signals in every state, defects."""

import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from builders import EPOCH, make_calibration
from robot import imu

from hgma_compensation.calibration.document import write_calibration
from hgma_compensation.demo.processes import HGMA, running

pytestmark = pytest.mark.ros
NODE = [sys.executable, "-m", "hgma_compensation.node.main"]
SIGNALS = [signal.SIGINT, signal.SIGTERM]


@pytest.fixture
def calibration_path(tmp_path):
    write_calibration(make_calibration(), tmp_path / "cal.json")
    return tmp_path / "cal.json"


def refused(environment, *arguments, command=NODE):
    """Run the node where it must refuse to start, and return the one line that it says."""
    words = [*command, "--ros-args", *arguments]
    done = subprocess.run(words, env=environment, capture_output=True, text=True, timeout=60)
    assert done.returncode == 2
    lines = [line for line in (done.stdout + done.stderr).splitlines() if "error: " in line]
    assert len(lines) == 1
    assert "Traceback" not in done.stdout + done.stderr
    return lines[0]


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ("autostart:=banana", ["autostart", "true or false", "banana"]),
        ("calibration_file:=7", ["calibration_file", "a text", "7"]),
        ("on_bad_temperature:=guess", ["on_bad_temperature", "'guess'", "continue, stop"]),
        ("use_sim_time:=later", ["use_sim_time", "later", "BOOL"]),
        ("qos_overrides./accel/raw.subscription.reliability:=good", ["/accel/raw", "'good'", "best_effort"]),
        ("qos_overrides./accel/raw.subscription.depth:=0", ["depth", "1 or more"]),
        ("qos_overrides./accel/state.publisher.depth:=many", ["depth", "'many'"]),
    ],
)
def test_a_parameter_that_cannot_be_used_is_refused_in_one_line(environment, given, words):
    line = refused(environment, "-p", given)
    assert all(word in line for word in words)


def test_arguments_and_files_that_ros_cannot_read_are_refused_in_one_line(environment, tmp_path):
    assert "autostart" in refused(environment, "-p", "autostart")
    assert "--nonsense" in refused(environment, "--nonsense")
    assert "none.yaml" in refused(environment, "--params-file", str(tmp_path / "none.yaml"))
    broken = tmp_path / "broken.yaml"
    broken.write_text("/**:\n  ros__parameters:\n    autostart: [true\n")
    refused(environment, "--params-file", str(broken))
    wrong = tmp_path / "wrong.yaml"
    wrong.write_text('/**:\n  ros__parameters:\n    autostart: "yes"\n')
    assert "true or false" in refused(environment, "--params-file", str(wrong))


def test_the_command_refuses_as_the_node_does(environment):
    assert "true or false" in refused(environment, "-p", "autostart:=banana", command=[*HGMA, "node"])


def test_a_parameter_that_nobody_knows_is_said_with_the_nearest_that_is_known(environment, robot):
    log = robot.log()
    given = ["calibration_fil:=x.json", "qos_overrides./accel/rax.subscription.depth:=7", "entirely_different:=1"]
    words = [word for parameter in given for word in ("-p", parameter)]
    with running([*NODE, "--ros-args", *words], environment, "no calibration yet"):
        robot.wait(lambda: sum("has no effect" in line for line in log) == 3, "three warnings")
    said = "\n".join(log)
    assert "no parameter calibration_fil, its value has no effect: did you mean calibration_file?" in said
    assert "/accel/rax.subscription.depth, its value has no effect: did you mean qos_overrides./accel/ra" in said
    assert "no parameter entirely_different" in said


def catches(pid, number):
    """Return whether a process has a handler of its own for a signal."""
    try:
        status = Path(f"/proc/{pid}/status").read_text()
    except OSError:
        return False
    return bool(int(re.search(r"SigCgt:\s*(\w+)", status)[1], 16) >> (number - 1) & 1)


@pytest.mark.parametrize("number", SIGNALS)
@pytest.mark.parametrize("command", [NODE, [*HGMA, "node"]], ids=["node", "hgma"])
def test_a_signal_while_ros_is_being_loaded_ends_it_with_0(environment, number, command):
    with subprocess.Popen(command, env=environment, stderr=subprocess.PIPE, text=True) as process:
        end = time.monotonic() + 30.0
        # Python has no handler for SIGTERM by itself: where there is one, ours are installed and ROS is not yet loaded.
        while not catches(process.pid, signal.SIGTERM):
            assert time.monotonic() < end
            time.sleep(0.001)
        process.send_signal(number)
        assert process.wait(30.0) == 0
        assert process.stderr.read() == ""


@pytest.mark.parametrize("number", SIGNALS)
def test_signals_end_the_unconfigured_node_with_0(environment, number):
    with running([*NODE, "--ros-args", "-p", "autostart:=false"], environment, "waiting to be configured") as process:
        process.send_signal(number)
        assert process.wait(20.0) == 0


@pytest.mark.parametrize("number", SIGNALS)
def test_signals_while_it_configures_end_it_with_0(environment, calibration_path, number):
    slow = (
        "import sys, time\nfrom hgma_compensation.node import streams as c\n"
        "opened = c.Streams.open\n"
        "def slowly(self):\n    print('opening', flush=True)\n    time.sleep(0.5)\n    opened(self)\n"
        "c.Streams.open = slowly\n"
        "from hgma_compensation.node.main import main\nsys.exit(main())"
    )
    command = [sys.executable, "-c", slow, "--ros-args", "-p", f"calibration_file:={calibration_path}"]
    with running(command, environment, "opening") as process:
        process.send_signal(number)
        assert process.wait(20.0) == 0


def test_signals_again_and_again_end_it_with_0(environment, calibration_path, robot):
    command = [*NODE, "--ros-args", "-p", f"calibration_file:={calibration_path}"]
    with running(command, environment, "using calibration") as process:
        robot.connect()
        robot.raw.publish(imu(EPOCH, [1.0] * 6))
        robot.wait(lambda: robot.compensated, "output")
        end = time.monotonic() + 20.0
        while process.poll() is None:
            assert time.monotonic() < end
            for number in SIGNALS:
                process.send_signal(number)
            time.sleep(0.002)
        assert process.returncode == 0


def test_a_defect_in_a_callback_is_said_once_and_ends_the_process_as_failed(environment, calibration_path, robot):
    defect = (
        "import sys\nfrom hgma_compensation.pipeline.live import LiveCompensation\n"
        "def broken(*_):\n    raise ZeroDivisionError('a defect')\n"
        "LiveCompensation.compensate = LiveCompensation.compensate_each = broken\n"
        "from hgma_compensation.node.main import main\nsys.exit(main())"
    )
    command = [sys.executable, "-c", defect, "--ros-args", "-p", f"calibration_file:={calibration_path}"]
    with subprocess.Popen(command, env=environment, stderr=subprocess.PIPE, text=True) as process:
        robot.connect()
        for number in range(10):
            robot.raw.publish(imu(EPOCH + number, [1.0] * 6))
        output = process.communicate(timeout=30.0)[1]
    assert process.returncode == 1
    assert output.count("internal error, the node ends: ZeroDivisionError: a defect") == 1
    assert output.count("Traceback") == 1
