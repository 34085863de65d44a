"""The subscriptions and publishers of the node's topics, which are created and destroyed together."""

from collections import Counter
from itertools import chain
from typing import cast

from rclpy.event_handler import EventHandler
from rclpy.lifecycle import LifecycleNode, LifecyclePublisher
from rclpy.subscription import Subscription

from hgma_compensation.node.interfaces import input_qos, output_qos, overridable
from hgma_compensation.node.losses import CountedInput
from hgma_compensation.node.qos_events import QosEvents
from hgma_compensation.node.stream_wait import StreamWait
from hgma_compensation.node.waiting_executor import Unwaited


class Endpoints:
    """Creates what a topic needs, with its QoS overrides and events; nothing stays behind at ``close``."""

    def __init__(self, node: LifecycleNode, counts: Counter[str]) -> None:
        """Take the node that owns the topics; counts: for losses and QoS that does not fit."""
        self._node, self._counts = node, counts
        self.events = QosEvents(node, counts)
        self.waiting = StreamWait(node.context)
        self._group = Unwaited()
        self._subscriptions: list[Subscription] = []
        self._publishers: list[LifecyclePublisher] = []

    def subscribe(self, message_type: type, topic: str) -> CountedInput:
        """Return an input whose messages are taken as bytes; ``waiting`` waits for them."""
        subscription = self._node.create_subscription(
            message_type,
            topic,
            _never_called,
            input_qos(topic),
            callback_group=self._group,
            event_callbacks=self.events.of_subscription(topic),
            qos_overriding_options=overridable(),
            raw=True,
        )
        self._subscriptions.append(subscription)
        self.waiting.watch(self._subscriptions)
        return CountedInput(topic, self._counts, subscription)

    def publish(self, message_type: type, topic: str) -> LifecyclePublisher:
        """Return a publisher that is silent while the node is not active."""
        publisher = self._node.create_lifecycle_publisher(
            message_type,
            topic,
            output_qos(topic),
            event_callbacks=self.events.of_publisher(topic),
            qos_overriding_options=overridable(),
        )
        self._publishers.append(publisher)
        return publisher

    def take_events(self) -> None:
        """Take note of publishers whose QoS does not fit the inputs', which nobody waits for; now and then."""
        # rclpy's annotation calls the list of handlers a handler.
        lists = [cast(list[EventHandler], subscription.event_handlers) for subscription in self._subscriptions]
        if lists:
            self.waiting.take_events(list(chain(*lists)))

    def close(self) -> None:
        """Destroy everything that was created; nothing where that was done before."""
        self.waiting.watch(())
        while self._subscriptions:
            self._node.destroy_subscription(self._subscriptions.pop())
        while self._publishers:
            self._node.destroy_lifecycle_publisher(self._publishers.pop())


def _never_called(_: bytes) -> None:
    """Stand where rclpy asks for a callback; the executor does not serve these subscriptions."""
