"""A process that publishes Imu at a fixed rate until its standard input ends: ``python -m benchmarks.soak.imu_source``.

x of the acceleration and x of the orientation are the number of the sample; the stamp is the time at which it is
published. A thermistor sample goes with each second. Prints one line of JSON at the end.
"""

import argparse
import json
import sys
import threading
import time

import rclpy
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import HistoryPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import Imu, Temperature

from benchmarks.soak.serialised import NUMBER, STAMP, STAMP_AT, acceleration_at, imu_template, orientation_at
from hgma_compensation import topics
from hgma_compensation.stamps import NANOSECONDS

QOS = QoSProfile(history=HistoryPolicy.KEEP_LAST, depth=10_000, reliability=ReliabilityPolicy.RELIABLE)
MATCHING = 0.5
"""s in which the node learns of the publisher that knows of the node already."""


def main() -> int:
    """Publish until standard input ends."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rate", type=float, default=1000.0, help="Hz")
    parser.add_argument("--history", type=int, default=0, help="thermistor samples sent beforehand, one a second old")
    options = parser.parse_args()
    stop = threading.Event()
    threading.Thread(target=_wait_for_end, args=(stop,), daemon=True).start()
    rclpy.init(args=[])
    node = Node("imu_source")
    raw = node.create_publisher(Imu, topics.RAW, QOS)
    temperature = node.create_publisher(Temperature, topics.TEMPERATURE, QOS)
    while not raw.get_subscription_count() or not temperature.get_subscription_count():
        time.sleep(0.02)
    time.sleep(MATCHING)
    for back in range(options.history, 0, -1):
        _publish_temperature(temperature, time.time_ns() - back * NANOSECONDS)
        time.sleep(0.001)
    sent, late = _publish(raw, temperature, options.rate, stop)
    time.sleep(MATCHING)
    node.destroy_node()
    rclpy.try_shutdown()
    print(json.dumps({"sent": sent, "latest": late}))
    return 0


def _wait_for_end(stop: threading.Event) -> None:
    sys.stdin.read()
    stop.set()


def _publish(raw: Publisher, temperature: Publisher, rate: float, stop: threading.Event) -> tuple[int, float]:
    """Publish until told to stop; return the number of samples, and by how much the latest of them came late, s."""
    message, places = imu_template(), (orientation_at(), acceleration_at())
    start, number, latest = time.monotonic(), 0, 0.0
    while not stop.is_set():
        wait = start + number / rate - time.monotonic()
        latest = max(latest, -wait)
        if wait > 0.0:
            time.sleep(wait)
        now = time.time_ns()
        if number % round(rate) == 0:
            _publish_temperature(temperature, now)
        STAMP.pack_into(message, STAMP_AT, *divmod(now, NANOSECONDS))
        for place in places:
            NUMBER.pack_into(message, place, float(number))
        raw.publish(bytes(message))
        number += 1
    return number, latest


def _publish_temperature(publisher: Publisher, stamp: int) -> None:
    message = Temperature(temperature=25.0)
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(stamp, NANOSECONDS)
    publisher.publish(message)


if __name__ == "__main__":
    sys.exit(main())
