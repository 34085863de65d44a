"""Messages of the log that cost the stream microseconds.

rclpy's logger finds out from which line it is called. For the first message it looks at the files of all modules that
are loaded, for some 50 ms, and at those of the callers again for each one after it.
"""

from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.impl.logging_severity import LoggingSeverity
from rclpy.node import Node


def info(node: Node, message: str) -> None:
    """Say something in the log."""
    _log(node, LoggingSeverity.INFO, message)


def warning(node: Node, message: str) -> None:
    """Say something in the log that an operator should look at."""
    _log(node, LoggingSeverity.WARN, message)


def error(node: Node, message: str) -> None:
    """Say something in the log that has failed."""
    _log(node, LoggingSeverity.ERROR, message)


def _log(node: Node, severity: LoggingSeverity, message: str) -> None:
    logger = node.get_logger()
    if logger.is_enabled_for(severity):
        rclpy_implementation.rclpy_logging_rcutils_log(severity, logger.name, message, "", "", 0)
