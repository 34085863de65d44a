"""QoS of the node's topics, and reading everything that a subscription holds."""

from collections.abc import Iterator
from typing import Any

from rclpy.qos import HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.qos_overriding_options import QoSOverridingOptions
from rclpy.subscription import Subscription

QUEUE = 1000
"""Messages held between two wake-ups: a second at 1 kHz."""

SETTLING = 0.5
"""s in which the other side of a connection learns of it: discovery is not symmetric. Also its grace at the end."""

# Sensor data as everywhere in ROS: whoever publishes reliably or not is heard.
INPUT_QOS = QoSProfile(history=HistoryPolicy.KEEP_LAST, depth=QUEUE, reliability=ReliabilityPolicy.BEST_EFFORT)
OUTPUT_QOS = QoSProfile(history=HistoryPolicy.KEEP_LAST, depth=QUEUE, reliability=ReliabilityPolicy.RELIABLE)


def overridable() -> QoSOverridingOptions:
    """Let history, depth and reliability of a topic be set by qos_overrides parameters."""
    return QoSOverridingOptions.with_default_policies()


def take_waiting(subscription: Subscription) -> Iterator[tuple[Any, Any]]:
    """Yield the messages that wait in a subscription, oldest first, each with what the middleware says of it.

    The executor wakes a callback for one message at a time, which costs more than the message.
    """
    for _ in range(QUEUE):
        with subscription.handle:
            taken = subscription.handle.take_message(subscription.msg_type, subscription.raw)
        if taken is None:
            return
        yield taken


def drain(subscription: Subscription) -> Iterator[Any]:
    """Yield the messages that wait in a subscription, oldest first."""
    return (message for message, _ in take_waiting(subscription))
