"""What the middleware says of a topic's other side: its QoS does not fit, so that nothing is sent or received."""

from collections import Counter
from typing import Any, Protocol

from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.qos import QoSCompatibility, qos_check_compatible, qos_policy_name_from_kind

from hgma_compensation.node import log
from hgma_compensation.node.parameters import QOS_PREFIX
from hgma_compensation.pipeline.transport import TRANSPORT_REMEDIES, incompatible_name


class IncompatibleQos(Protocol):
    """rclpy's event: a policy of the other side that does not fit."""

    total_count_change: int
    last_policy_kind: Any


class QosEvents:
    """Callbacks for the node's topics; each policy of a topic is logged once, each event counted."""

    def __init__(self, node: Node, counts: Counter[str]) -> None:
        """Count into ``counts``, log as the node."""
        self._node, self._counts = node, counts
        self._said: set[tuple[str, str]] = set()

    def of_subscription(self, topic: str) -> SubscriptionEventCallbacks:
        """Return the callbacks for an input."""
        return SubscriptionEventCallbacks(incompatible_qos=lambda event: self._on_publisher(topic, event))

    def of_publisher(self, topic: str) -> PublisherEventCallbacks:
        """Return the callbacks for an output."""
        return PublisherEventCallbacks(incompatible_qos=lambda event: self._on_subscriber(topic, event))

    def problems(self) -> list[str]:
        """Return a sentence for each topic that has another side now whose QoS does not fit.

        The middleware says when such a side comes and not when it goes, so the graph is asked; of topics only where
        one has come.
        """
        topics = sorted({topic for topic, _ in self._said})
        names = [incompatible_name(topic) for topic in topics if self._unfit(topic)]
        return [f"{name}: {TRANSPORT_REMEDIES[name]}" for name in names]

    def values(self) -> list[tuple[str, str]]:
        """Return no figures: the counts are among those of the samples."""
        return []

    def _unfit(self, topic: str) -> bool:
        publishers = self._node.get_publishers_info_by_topic(topic)
        subscribers = self._node.get_subscriptions_info_by_topic(topic)
        name, namespace = self._node.get_name(), self._node.get_namespace()
        return any(
            qos_check_compatible(publisher.qos_profile, subscriber.qos_profile)[0] == QoSCompatibility.ERROR
            for publisher in publishers
            for subscriber in subscribers
            if any((side.node_name, side.node_namespace) == (name, namespace) for side in (publisher, subscriber))
        )

    def _on_publisher(self, topic: str, event: IncompatibleQos) -> None:
        self._say(topic, event, "subscription", "a publisher of {} offers less than this node asks: it is not heard")

    def _on_subscriber(self, topic: str, event: IncompatibleQos) -> None:
        self._say(topic, event, "publisher", "a subscriber of {} asks more than this node offers: it gets nothing")

    def _say(self, topic: str, event: IncompatibleQos, side: str, sentence: str) -> None:
        self._counts[incompatible_name(topic)] += event.total_count_change
        policy = qos_policy_name_from_kind(event.last_policy_kind).lower()
        if (topic, policy) in self._said:
            return
        self._said.add((topic, policy))
        name = self._node.resolve_topic_name(topic)
        remedy = f"change it there, or set {QOS_PREFIX}{name}.{side}.{policy} here"
        log.warning(self._node, f"{sentence.format(name)} (policy {policy}); {remedy}")
