"""A ROS node for the length of a command."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from hgma_compensation.errors import RefusedError


@contextmanager
def ros_required() -> Iterator[None]:
    """Import what needs ROS inside of this: raises RefusedError with the remedy where it is not installed."""
    try:
        yield
    except ImportError as error:
        raise RefusedError(f"rclpy is not installed ({error}): run make, or source your ROS 2 workspace") from error


@contextmanager
def ros_node(name: str) -> Iterator[Any]:
    """Give a node, which SIGINT and SIGTERM interrupt as a KeyboardInterrupt, and end ROS after it."""
    import rclpy  # only the commands that talk to ROS need it
    from rclpy.signals import SignalHandlerOptions

    # SIGINT too: a shell starts what it puts into the background with that ignored.
    for ending in (signal.SIGINT, signal.SIGTERM):
        signal.signal(ending, signal.default_int_handler)
    # Python's handlers interrupt a sleep or a wait; rclpy's race with its own shutdown.
    rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
    node = rclpy.create_node(name)
    try:
        yield node
    finally:
        node.destroy_node()
        rclpy.try_shutdown()
