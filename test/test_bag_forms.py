"""Every command does the same with a bag in each form that rosbag2 records."""

import json
import subprocess
from itertools import product

import pytest
from bag_forms import FORMS, written
from builders import make_calibration, make_recording
from rosbags.rosbag2 import Reader
from sensor_msgs.msg import Imu, Temperature

from hgma_compensation.calibration.document import write_calibration
from hgma_compensation.cli.main import main
from hgma_compensation.demo.processes import HGMA
from hgma_compensation.recording.bag_writer import Storage

ALL = [pytest.param(storage, form, id=f"{storage.value}-{form}") for storage, form in product(Storage, FORMS)]
SHORT = make_recording(duration_s=2.0, accel_rate=10.0, thermistor_rate=2.0, cycles=1.0, name="bag")
LONG = make_recording(duration_s=300.0, cycles=2.0, name="bag")


def run(*words):
    assert main([str(word) for word in words]) == 0


def results(folder, bag, cal):
    """Return what the offline commands make of a bag."""
    run("evaluate", bag, "--calibration", cal, "--json", folder / "evaluation.json")
    run("train", bag, "-o", folder / "trained.json", "--method", "polynomial", "--json", folder / "training.json")
    run("compensate", bag, "--calibration", cal, "-o", folder / "out")
    with Reader(folder / "out") as reader:
        messages = [(connection.topic, time, bytes(raw)) for connection, time, raw in reader.messages()]
    return (
        json.loads((folder / "evaluation.json").read_text()),
        json.loads((folder / "trained.json").read_text())["channels"],
        messages,
    )


@pytest.fixture(scope="module")
def expected(tmp_path_factory):
    folder = tmp_path_factory.mktemp("plain")
    write_calibration(make_calibration(), folder / "cal.json")
    return folder / "cal.json", results(folder, written(LONG, folder / "bag"), folder / "cal.json")


@pytest.mark.parametrize(("storage", "form"), ALL)
def test_offline_commands_give_what_they_give_for_a_plain_bag(tmp_path, storage, form, expected):
    cal, (evaluation, trained, messages) = expected
    bag = written(LONG, tmp_path / "bag", storage, form)
    assert results(tmp_path, bag, cal) == (evaluation, trained, messages)


@pytest.mark.ros
@pytest.mark.slow
@pytest.mark.parametrize("form", ["message", "file", "split"])
@pytest.mark.parametrize("storage", list(Storage))
def test_play_publishes_every_message(tmp_path, storage, form, robot, environment):
    bag = written(SHORT, tmp_path / "bag", storage, form)
    raw = robot.collect(Imu, "accel/raw")
    temperature = robot.collect(Temperature, "accel/temperature")
    command = [*HGMA, "play", str(bag), "--rate", "10", "--wait", "20"]
    player = subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True)
    try:
        robot.wait(lambda: len(raw) == len(SHORT.stamps), "all samples")
        robot.wait(lambda: len(temperature) == len(SHORT.temperature.stamps), "all temperatures")
        assert player.wait(20.0) == 0
    finally:
        player.kill()
        player.wait()
