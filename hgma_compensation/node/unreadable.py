"""Serialised messages that may be none."""

from typing import Any

from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.serialization import deserialize_message


def read(raw: bytes, message_type: type) -> Any:
    """Return the message that bytes hold, None where they hold none of that type."""
    try:
        return deserialize_message(raw, message_type)
    except rclpy_implementation.RMWError:
        return None
