"""The topic /diagnostics, once a second of the node's clock."""

from collections.abc import Callable, Sequence

from diagnostic_msgs.msg import DiagnosticArray
from rclpy.node import Node

from hgma_compensation.node.diagnostics import DiagnosticReport, Reporter
from hgma_compensation.node.ros_clock import RosClock
from hgma_compensation.pipeline.live import LiveCompensation

PERIOD = 1.0
"""s."""


class Reporting:
    """Publishes the node's state in words; rclpy keeps the object with the node."""

    def __init__(
        self,
        node: Node,
        live: LiveCompensation,
        reporters: Sequence[Reporter],
        state: Callable[[], tuple[str, str]],
    ) -> None:
        """Report for the parts of the node too that have something to say.

        state: returns that of the lifecycle, and why the last calibration was refused, "" if it was not.
        """
        self._node, self._live, self._state = node, live, state
        name = f"{node.get_fully_qualified_name().lstrip('/')}: compensation"
        self._report = DiagnosticReport(name, reporters)
        self._publisher = node.create_publisher(DiagnosticArray, "/diagnostics", 10)
        self._clock = RosClock(node, live.counts)
        node.create_timer(PERIOD, self._publish)

    def _publish(self) -> None:
        status = self._report.status(self._live, *self._state(), self._clock.elapsed())
        array = DiagnosticArray(status=[status])
        array.header.stamp = self._node.get_clock().now().to_msg()
        self._publisher.publish(array)
