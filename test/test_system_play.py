"""Recording, node and player together: what `make demo` does, on a short recording."""

import subprocess
from dataclasses import replace

import numpy as np
import pytest
from builders import make_calibration, make_recording
from robot import Robot
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Imu, Temperature

from hgma_compensation import topics
from hgma_compensation.calibration.document import write_calibration
from hgma_compensation.channels import CHANNELS, columns_of
from hgma_compensation.cli.main import main
from hgma_compensation.demo.live_run import run_live
from hgma_compensation.demo.processes import HGMA, private_ros_environment
from hgma_compensation.kalman.settings import FilterMode
from hgma_compensation.messages import imu_values, stamp_of
from hgma_compensation.recording.bag_reader import read_recording
from hgma_compensation.recording.bag_writer import Storage, write_recording
from hgma_compensation.stamps import NANOSECONDS

pytestmark = pytest.mark.ros
COMPENSATED = topics.TopicNames([f"/{topics.RAW}:=/{topics.COMPENSATED}"])


@pytest.mark.parametrize("storage", list(Storage))
def test_the_node_publishes_what_compensate_writes(tmp_path, storage):
    channels = (*CHANNELS[:3], CHANNELS[5])
    recording = make_recording(duration_s=100.0, accel_rate=20.0, thermistor_rate=1.0, channels=channels)
    calibration = make_calibration(channels=channels, mode=FilterMode.SMOOTH, latency=1.0)
    cal, bag = tmp_path / "cal.json", tmp_path / "bag"
    write_calibration(calibration, cal)
    write_recording(recording, bag, storage)
    counts = run_live(bag, cal, tmp_path / "live", rate=10.0, samples=len(recording.stamps))
    assert main(["compensate", str(bag), "--calibration", str(cal), "-o", str(tmp_path / "offline")]) == 0
    live, offline = (read_recording(tmp_path / name, COMPENSATED) for name in ("live", "offline"))
    assert set(counts.values()) == {len(recording.stamps)}
    assert live.frame == offline.frame == recording.frame
    np.testing.assert_array_equal(live.stamps, recording.stamps)
    np.testing.assert_allclose(live.values, offline.values, rtol=1e-9, atol=0.0)
    untouched = [column for column in range(6) if column not in columns_of(channels)]
    np.testing.assert_array_equal(live.values[:, untouched], recording.values[:, untouched])


def test_play_keeps_stamps_and_content_and_tells_the_time(tmp_path):
    recording = make_recording(duration_s=2.0, accel_rate=10.0, thermistor_rate=2.0, cycles=1.0)
    bag = tmp_path / "bag"
    write_recording(replace(recording, frame="link_7"), bag)
    environment = private_ros_environment()
    robot = Robot(int(environment["ROS_DOMAIN_ID"]))
    robot.collect(Temperature, "accel/temperature")  # the player waits for both inputs to be heard
    raw, clock = (robot.collect(kind, name) for kind, name in ((Imu, "accel/raw"), (Clock, "/clock")))
    command = [*HGMA, "play", str(bag), "--rate", "4", "--clock", "--wait", "20"]
    player = subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True)
    try:
        robot.wait(lambda: len(raw) == len(recording.stamps), "all samples")
        assert player.wait(20.0) == 0
    finally:
        player.kill()
        player.wait()
        robot.close()
    assert [stamp_of(message) for message in raw] == recording.stamps.tolist()
    np.testing.assert_array_equal([imu_values(message) for message in raw], recording.values)
    assert {message.header.frame_id for message in raw} == {"link_7"}
    times = [message.clock.sec * NANOSECONDS + message.clock.nanosec for message in clock]
    assert times == sorted(times)
    assert recording.start <= times[0]
    assert times[-1] <= recording.stamps[-1]
    assert player.stdout.read().strip().endswith(f"{len(raw) + len(recording.temperature.stamps)} messages played")


def test_play_loops_until_it_is_stopped(tmp_path):
    recording = make_recording(duration_s=1.0, accel_rate=10.0, thermistor_rate=2.0, cycles=1.0)
    write_recording(recording, tmp_path / "bag")
    environment = private_ros_environment()
    robot = Robot(int(environment["ROS_DOMAIN_ID"]))
    raw = robot.collect(Imu, "accel/raw")
    player = subprocess.Popen([*HGMA, "play", str(tmp_path / "bag"), "--loop", "--rate", "5"], env=environment)
    try:
        robot.wait(lambda: len(raw) > 25, "two rounds and a half")
        player.terminate()
        assert player.wait(20.0) == 0
    finally:
        player.kill()
        player.wait()
        robot.close()
    stamps = [stamp_of(message) for message in raw]
    assert stamps.count(int(recording.stamps[5])) >= 2
