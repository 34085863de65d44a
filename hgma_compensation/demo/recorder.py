"""Records topics to a rosbag2 folder, for machines without ``ros2 bag record``."""

import time
from collections import Counter
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.subscription import Subscription

from hgma_compensation.node.interfaces import SETTLING, drain
from hgma_compensation.node.message_types import message_class
from hgma_compensation.recording.bag_writer import BagWriter, new_bag

QOS = QoSProfile(history=HistoryPolicy.KEEP_LAST, depth=10_000, reliability=ReliabilityPolicy.RELIABLE)


class _Recorder:
    """Writes what arrives, serialised as it arrived."""

    def __init__(self, node: Any, bag: BagWriter, topics: Mapping[str, str]) -> None:
        self.counts: Counter[str] = Counter()
        for topic, message_type in topics.items():
            self._subscribe(node, bag, topic, message_type)

    def _subscribe(self, node: Any, bag: BagWriter, topic: str, message_type: str) -> None:
        connection = bag.topic(topic, message_type)

        def take(raw: bytes) -> None:
            bag.write_raw(connection, time.time_ns(), raw)
            self.counts[topic] += 1

        def on_message(raw: bytes) -> None:
            take(raw)
            for waiting in drain(subscription):
                take(waiting)

        subscription: Subscription = node.create_subscription(
            message_class(message_type), topic, on_message, QOS, raw=True
        )


def record(
    path: Path,
    topics: Mapping[str, str],
    domain: int,
    *,
    connected: Callable[[], None],
    until: Callable[[Mapping[str, int]], bool],
) -> Mapping[str, int]:
    """Record topics (name to message type) until the condition on the counts holds; return the counts.

    connected: called once every topic has a publisher, before which nothing that matters may be sent.
    """
    context = rclpy.Context()
    rclpy.init(args=[], context=context, domain_id=domain)
    node = rclpy.create_node("recorder", context=context)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)
    try:
        with new_bag(path) as bag:
            recorder = _Recorder(node, bag, topics)
            while not all(node.count_publishers(topic) for topic in topics):
                executor.spin_once(timeout_sec=0.05)
            time.sleep(SETTLING)
            connected()
            while not until(recorder.counts):
                executor.spin_once(timeout_sec=0.05)
            return recorder.counts
    finally:
        executor.shutdown()
        node.destroy_node()
        context.try_shutdown()
