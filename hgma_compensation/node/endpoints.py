"""The subscriptions and publishers of the node's topics, which are created and destroyed together."""

from collections import Counter
from collections.abc import Callable
from copy import copy
from typing import Any

from rclpy.lifecycle import LifecycleNode, LifecyclePublisher
from rclpy.subscription import Subscription

from hgma_compensation.node.interfaces import INPUT_QOS, OUTPUT_QOS, overridable
from hgma_compensation.node.losses import CountedInput, MessageInfo
from hgma_compensation.node.qos_events import QosEvents


class Endpoints:
    """Creates what a topic needs, with its QoS overrides and events; nothing stays behind at ``close``."""

    def __init__(self, node: LifecycleNode, counts: Counter[str]) -> None:
        """Take the node that owns the topics; counts: for losses and QoS that does not fit."""
        self._node, self._counts = node, counts
        self.events = QosEvents(node, counts)
        self._subscriptions: list[Subscription] = []
        self._publishers: list[LifecyclePublisher] = []

    def subscribe(self, message_type: type, topic: str, take: Callable[[Any], None]) -> CountedInput:
        """Give every message of a topic to ``take``."""
        counted = CountedInput(topic, self._counts)

        def on_message(message: Any, info: MessageInfo) -> None:
            counted.saw(info)
            take(message)

        callback: Callable[..., None] = on_message  # rclpy's annotation knows callbacks of one argument only
        counted.subscription = self._node.create_subscription(
            message_type,
            topic,
            callback,
            copy(INPUT_QOS),  # rclpy writes the overrides of one topic into the profile it is given
            event_callbacks=self.events.of_subscription(topic),
            qos_overriding_options=overridable(),
        )
        self._subscriptions.append(counted.subscription)
        return counted

    def publish(self, message_type: type, topic: str) -> LifecyclePublisher:
        """Return a publisher that is silent while the node is not active."""
        publisher = self._node.create_lifecycle_publisher(
            message_type,
            topic,
            copy(OUTPUT_QOS),
            event_callbacks=self.events.of_publisher(topic),
            qos_overriding_options=overridable(),
        )
        self._publishers.append(publisher)
        return publisher

    def close(self) -> None:
        """Destroy everything that was created; nothing where that was done before."""
        while self._subscriptions:
            self._node.destroy_subscription(self._subscriptions.pop())
        while self._publishers:
            self._node.destroy_lifecycle_publisher(self._publishers.pop())
