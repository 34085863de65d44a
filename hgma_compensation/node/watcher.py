"""Listens to a node's topics for ``hgma watch``."""

from collections.abc import Callable
from contextlib import suppress
from functools import partial
from typing import Any

import numpy as np
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.node import Node
from rclpy.qos import HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message
from sensor_msgs.msg import Imu

from hgma_compensation import topics
from hgma_compensation.cdr.imu import batches
from hgma_compensation.errors import RefusedError
from hgma_compensation.messages import block_samples, imu_values, widen_block
from hgma_compensation.node.interfaces import drain
from hgma_compensation.watching.window import Samples, Window
from hgma_msgs.msg import AccelBlock, CompensationState

QOS = QoSProfile(history=HistoryPolicy.KEEP_LAST, depth=2000, reliability=ReliabilityPolicy.BEST_EFFORT)
IMU = "sensor_msgs/msg/Imu"
NODE = "compensation_node"


class Watcher:
    """Sums up what comes on the accelerometer's topics and the node's state, until it is asked."""

    def __init__(self, node: Node, name: Callable[[str], str]) -> None:
        """Subscribe on a node of the caller's; name: gives the name of one of the node's topics."""
        self._node, self._name, self.window = node, name, Window()
        for topic in (topics.RAW, topics.COMPENSATED):
            self._listen(Imu, name(topic), partial(self._imus, topic), raw=True)
        for topic in (topics.RAW_BLOCK, topics.COMPENSATED_BLOCK):
            self._listen(AccelBlock, name(topic), partial(self._blocks, topic))
        self._listen(CompensationState, name(topics.STATE), self._states)
        self._listen(DiagnosticArray, "/diagnostics", self._diagnostics)

    def take(self) -> Window:
        """Return what came since the last call."""
        window, self.window = self.window, self.window.next()
        return window

    def advice(self, window: Window) -> str:
        """Return what to do where nothing comes, "" where all is well."""
        raw, compensated = self._name(topics.RAW), self._name(topics.COMPENSATED)
        if not window.raw.count:
            others = sorted(name for name, types in self._node.get_topic_names_and_types() if IMU in types)
            others = [name for name in others if name not in (raw, compensated)]
            rule = f"--remap {topics.in_bag(topics.RAW)}:={others[0] if len(others) == 1 else 'ITS_NAME'}"
            seen = f"; sensor_msgs/Imu is on {', '.join(others)}: {rule}" if others else ""
            return f"nothing comes on {raw}: start the driver or hgma play{seen}"
        if not window.compensated.count:
            if self._node.count_publishers(compensated):
                return f"{compensated} is silent: see the node's diagnostics (a calibration may be missing)"
            return f"nobody publishes {compensated}: start the node with hgma node, or --remap it"
        return ""

    def _listen(self, kind: Any, topic: str, take: Callable[[list[Any]], None], *, raw: bool = False) -> None:
        subscription = self._node.create_subscription(
            kind, topic, lambda first: take([first, *drain(subscription)]), QOS, raw=raw
        )

    def _samples(self, topic: str) -> Samples:
        return self.window.raw if topic in (topics.RAW, topics.RAW_BLOCK) else self.window.compensated

    def _imus(self, topic: str, raws: list[bytes]) -> None:
        for place, batch in batches(raws):
            if batch is not None:
                values = batch.values
            else:
                values = np.array([imu_values(deserialize_message(raw, Imu)) for raw in raws[place]])
            self._samples(topic).add(values)

    def _blocks(self, topic: str, blocks: list[Any]) -> None:
        for block in blocks:
            with suppress(RefusedError):  # the node counts and names such a block in its diagnostics
                self._samples(topic).add(widen_block(block_samples(block, topic)[1]))

    def _states(self, states: list[Any]) -> None:
        self.window.states += len(states)
        self.window.state = states[-1]

    def _diagnostics(self, arrays: list[Any]) -> None:
        for array in arrays:
            for status in array.status:
                if NODE in status.name:
                    self.window.condition = (status.level, status.message)
