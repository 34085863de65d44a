"""A bag that loops through the real node, whose output must be the same each time: ``make soak``.

The bag has a shock, a thermistor that falls silent and one that jumps; the calibration has Kalman stages and memories
of temperature and acceleration. Prints one line of JSON; exit code 1 where a round differs from the first by a byte.
"""

import argparse
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import HistoryPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import Imu

from benchmarks.soak.faults.calibrations import write_calibrations
from benchmarks.soak.faults.segment import START, celsius, drift
from benchmarks.soak.reliable_inputs import RELIABLE
from hgma_compensation import topics
from hgma_compensation.channels import CHANNELS
from hgma_compensation.demo.processes import HGMA, private_ros_environment, running
from hgma_compensation.recording.bag_writer import write_recording
from hgma_compensation.recording.recording import Recording, Series
from hgma_compensation.stamps import NANOSECONDS
from hgma_msgs.msg import CompensationState

SECONDS, RATE, THERMISTOR_RATE = 30.0, 100, 5
QOS = QoSProfile(history=HistoryPolicy.KEEP_LAST, depth=20_000, reliability=ReliabilityPolicy.RELIABLE)
SILENCE = 30.0
"""s without an output after which the stream has failed."""


def main() -> int:
    """Run the soak."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=20)
    parser.add_argument("--speed", type=float, default=4.0, help="of the bag's time")
    options = parser.parse_args()
    environment = private_ros_environment()
    with tempfile.TemporaryDirectory() as folder:
        (good, *_), _ = write_calibrations(Path(folder))
        write_recording(make_recording(), Path(folder) / "bag")
        words = [
            word
            for parameter in (f"calibration_file:={good}", "state_rate:=0.0", *RELIABLE)
            for word in ("-p", parameter)
        ]
        node = [sys.executable, "-m", "hgma_compensation.node.main", "--ros-args", *words]
        play = [*HGMA, "play", str(Path(folder) / "bag"), "--loop", "--rate", str(options.speed), "--wait", "30"]
        with running(node, environment, "using calibration"):
            outputs = _collect(int(environment["ROS_DOMAIN_ID"]), play, environment, options.rounds)
    figures = _figures(outputs, options.rounds)
    print(json.dumps(figures))
    return 1 if figures["rounds_that_differ"] else 0


def make_recording() -> Recording:
    """Return a still sensor with a shock, whose thermistor jumps once and falls silent once."""
    random = np.random.default_rng(20)
    time_s = np.arange(int(SECONDS * RATE)) / RATE
    thermistor_s = np.arange(int(SECONDS * THERMISTOR_RATE)) / THERMISTOR_RATE
    # The oven of the faults at ten times its speed.
    values = np.array([9.81 + drift(celsius(10.0 * second)) for second in time_s])
    values = values[:, None] + 0.1 * random.standard_normal((len(values), len(CHANNELS)))
    values[1200:1205, :3] += 1e4
    measured = np.array([celsius(10.0 * second) for second in thermistor_s]) + 0.01 * random.standard_normal(
        len(thermistor_s)
    )
    measured[40] = 200.0
    heard = (thermistor_s < 15.0) | (thermistor_s > 22.0)
    series = Series(_stamps(thermistor_s[heard]), measured[heard])
    return Recording("loop", _stamps(time_s), values, CHANNELS, series)


def _stamps(seconds: Any) -> Any:
    return START + np.rint(seconds * NANOSECONDS).astype(np.int64)


def _collect(domain: int, play: list[str], environment: dict[str, str], rounds: int) -> dict[str, list[bytes]]:
    """Return the serialised messages of both topics while the bag plays."""
    context = rclpy.Context()
    rclpy.init(args=[], context=context, domain_id=domain)
    node = rclpy.create_node("soak_loops", context=context)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)
    outputs: dict[str, list[bytes]] = {topics.COMPENSATED: [], topics.STATE: []}
    for kind, topic in ((Imu, topics.COMPENSATED), (CompensationState, topics.STATE)):
        node.create_subscription(kind, topic, outputs[topic].append, QOS, raw=True)
    wanted = rounds * int(SECONDS * RATE)
    player = subprocess.Popen(play, env=environment, stdout=subprocess.DEVNULL)
    last, heard = time.monotonic(), 0
    while min(map(len, outputs.values())) < wanted and time.monotonic() - last < SILENCE:
        executor.spin_once(timeout_sec=0.5)
        if (count := len(outputs[topics.COMPENSATED])) > heard:
            last, heard = time.monotonic(), count
    player.terminate()
    player.wait(SILENCE)
    executor.shutdown()
    node.destroy_node()
    context.try_shutdown()
    return outputs


def _figures(outputs: dict[str, list[bytes]], rounds: int) -> dict[str, Any]:
    count = int(SECONDS * RATE)
    different = 0
    for number in range(rounds):
        part = slice(number * count, (number + 1) * count)
        different += any(messages[part] != messages[:count] for messages in outputs.values())
    return {
        "rounds": rounds,
        "rounds_that_differ": different,
        "samples_each": count,
        "outputs": len(outputs[topics.COMPENSATED]),
        "states": len(outputs[topics.STATE]),
    }


if __name__ == "__main__":
    sys.exit(main())
