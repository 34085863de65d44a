"""The other end of the node under test: asks it to load files, and takes its outputs meanwhile."""

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from rcl_interfaces.srv import SetParameters
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter

from hgma_compensation import topics
from hgma_msgs.srv import LoadCalibration

NODE = "/compensation_node"
ANSWERED = 30.0
"""s after which a request counts as unanswered."""
MATCHING = 0.5
"""s in which the node learns of what knows of the node already."""


class ReloadClient:
    """A ROS context of its own in a domain; ``listener`` is a node for subscriptions that nobody spins."""

    def __init__(self, domain: int) -> None:
        """Connect to the node, which runs already."""
        self._context = rclpy.Context()
        rclpy.init(args=[], context=self._context, domain_id=domain)
        self._node = Node("soak_client", context=self._context)
        self.listener = Node("soak_listener", context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        self._services = (
            self._node.create_client(LoadCalibration, f"{NODE}/load_calibration"),
            self._node.create_client(SetParameters, f"{NODE}/set_parameters"),
        )
        self._node.create_subscription(DiagnosticArray, "/diagnostics", self._on_diagnostics, 10)
        self._diagnostics: dict[str, str] = {}
        while not all(client.service_is_ready() for client in self._services):
            time.sleep(0.05)

    def wait_for_outputs(self) -> None:
        """Wait until the node's outputs reach the listener."""
        while not all(self.listener.count_publishers(topic) for topic in (topics.COMPENSATED, topics.STATE)):
            time.sleep(0.05)
        time.sleep(MATCHING)

    def load(self, path: Path, by_parameter: bool, meanwhile: Callable[[], None]) -> bool:
        """Ask for a file by the service or by the parameter, and return whether it was accepted."""
        if by_parameter:
            value = Parameter("calibration_file", value=str(path)).to_parameter_msg()
            answer = self._call(1, SetParameters.Request(parameters=[value]), meanwhile)
            return bool(answer.results[0].successful)
        return bool(self._call(0, LoadCalibration.Request(path=str(path)), meanwhile).success)

    def _call(self, service: int, request: Any, meanwhile: Callable[[], None]) -> Any:
        future = self._services[service].call_async(request)
        end = time.monotonic() + ANSWERED
        while not future.done():
            if time.monotonic() > end:
                raise RuntimeError(f"the node did not answer within {ANSWERED:g} s")
            self._executor.spin_once(timeout_sec=0.002)
            meanwhile()
        return future.result()

    def received_by_node(self) -> int:
        """Return how many samples the node says it received, after the next two reports."""
        for _ in range(2):
            self._diagnostics.clear()
            end = time.monotonic() + ANSWERED
            while not self._diagnostics and time.monotonic() < end:
                self._executor.spin_once(timeout_sec=0.1)
        return int(self._diagnostics["samples_received"])

    def _on_diagnostics(self, message: DiagnosticArray) -> None:
        self._diagnostics = {value.key: value.value for value in message.status[0].values}

    def close(self) -> None:
        """Leave ROS."""
        self._executor.shutdown()
        for node in (self._node, self.listener):
            node.destroy_node()
        self._context.try_shutdown()
