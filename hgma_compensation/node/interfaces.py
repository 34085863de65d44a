"""QoS of the node's topics, and reading everything that a subscription holds."""

from collections.abc import Iterator
from typing import Any

from rclpy.qos import HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.qos_overriding_options import QoSOverridingOptions
from rclpy.subscription import Subscription

from hgma_compensation import topics

QUEUE = 1000
"""Messages held between two wake-ups."""

SAMPLE_QUEUE = 20_000
"""The same where each sample is a message: a second at 20 kHz, many times what a report or a new calibration takes.

Fast DDS takes memory for the messages that wait, not for those that could.
"""

SETTLING = 0.5
"""s in which the other side of a connection learns of it: discovery is not symmetric. Also its grace at the end."""


def input_qos(topic: str) -> QoSProfile:
    """Return the profile of an input, of sensor data as everywhere: whoever publishes reliably or not is heard."""
    return _profile(topic, ReliabilityPolicy.BEST_EFFORT)


def output_qos(topic: str) -> QoSProfile:
    """Return the profile of an output, which serves readers that ask for reliability and those that do not."""
    return _profile(topic, ReliabilityPolicy.RELIABLE)


def _profile(topic: str, reliability: ReliabilityPolicy) -> QoSProfile:
    depth = SAMPLE_QUEUE if topic in (topics.RAW, topics.COMPENSATED) else QUEUE
    return QoSProfile(history=HistoryPolicy.KEEP_LAST, depth=depth, reliability=reliability)


def overridable() -> QoSOverridingOptions:
    """Let history, depth and reliability of a topic be set by qos_overrides parameters."""
    return QoSOverridingOptions.with_default_policies()


def take_waiting(subscription: Subscription, most: int = QUEUE) -> Iterator[tuple[Any, Any]]:
    """Yield up to ``most`` messages that wait, oldest first, each with what the middleware says of it.

    An executor wakes a callback for one message at a time, which costs more than the message.
    """
    for _ in range(most):
        with subscription.handle:
            taken = subscription.handle.take_message(subscription.msg_type, subscription.raw)
        if taken is None:
            return
        yield taken


def drain(subscription: Subscription) -> Iterator[Any]:
    """Yield the messages that wait in a subscription, oldest first."""
    return (message for message, _ in take_waiting(subscription))
