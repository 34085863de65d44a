"""The life of the node's process: start, spin, end."""

import gc
import sys
import threading
import traceback
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

import rclpy
from rclpy.exceptions import ParameterException
from rclpy.executors import ExternalShutdownException
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.signals import SignalHandlerOptions

from hgma_compensation.errors import RefusedError
from hgma_compensation.kept_memory import keep_memory

if TYPE_CHECKING:  # else imported while DDS looks for its peers
    from hgma_compensation.node.compensation_node import CompensationNode
    from hgma_compensation.node.waiting_executor import WaitingExecutor

STOP_LATENCY = 200_000_000
"""ns after which a signal is noticed at the latest."""

FAILED = 1

GIVE_WAY = 1e-4
"""s for which the thread that saves the memory may keep the interpreter from the one that compensates."""


def run(args: Sequence[str], stop: threading.Event) -> int:
    """Run the node until ``stop`` is set or ROS is shut down; return the exit code.

    Raises RefusedError for arguments and parameters that cannot be used.
    """
    if stop.is_set():
        return 0
    try:
        # rclpy's own handlers wake the executor from a thread of theirs, which races with its destruction and
        # crashes about one end in twenty (Jazzy, 7.1.6).
        _initialise(args)
        with _discovery():
            node = _create()
        from hgma_compensation.node.waiting_executor import WaitingExecutor

        executor = WaitingExecutor(node.streams.endpoints.waiting.wake)
        executor.add_node(node)
        try:
            return _spin(node, executor, stop)
        finally:
            executor.shutdown()
            node.destroy_node()
    finally:
        rclpy.try_shutdown()


def _initialise(args: Sequence[str]) -> None:
    try:
        rclpy.init(args=list(args), signal_handler_options=SignalHandlerOptions.NO)
    except rclpy_implementation.UnknownROSArgsError as error:
        raise RefusedError(f"arguments: ROS knows nothing of {error} after --ros-args") from error
    except rclpy_implementation.RCLError as error:
        raise RefusedError(f"arguments: {_cause(error)}") from error


@contextmanager
def _discovery() -> Iterator[None]:
    """Let DDS look for its peers from now on, which takes as long as it takes to load the rest of this program.

    It begins with the first node of a context. Names that begin with an underscore are hidden from ``ros2 node list``.
    """
    context = rclpy.get_default_context().handle
    assert context is not None
    # A node of rcl, without the topics, parameters and services that rclpy adds to it.
    with context:
        first = rclpy_implementation.Node("_compensation_node_start", "", context, None, False, False)
    try:
        yield
    finally:
        first.destroy_when_not_in_use()


def _create() -> "CompensationNode":
    from hgma_compensation.node.compensation_node import CompensationNode

    try:
        return CompensationNode()
    except (ParameterException, rclpy_implementation.RCLError) as error:
        raise RefusedError(f"parameters: {_cause(error)}") from error


def _cause(error: Exception) -> str:
    """Return what rcl says without the places in its source, which it appends."""
    return str(error).partition(", at /")[0].strip()


def _spin(node: "CompensationNode", executor: "WaitingExecutor", stop: threading.Event) -> int:
    """Serve samples and callbacks, all in this thread; an exception is a defect of this program, and ends it.

    What a half-finished callback leaves of filter and memories is unknown, and output computed from it would look like
    any other: whoever started the process sees it fail, and starts it anew from a known state.
    """
    try:
        node.start()
        node.offer()
        keep_memory()
        share_interpreter()
        executor.start()
        streams, waiting = node.streams, node.streams.endpoints.waiting
        while not stop.is_set():
            if waiting.wait(STOP_LATENCY):
                streams.serve()
            executor.spin_once()
    except ExternalShutdownException:
        pass
    except Exception as error:
        from hgma_compensation.node.managed_node import described

        node.get_logger().fatal(f"internal error, the node ends: {described(error)}\n{traceback.format_exc()}")
        return FAILED
    return 0


def share_interpreter() -> None:
    """Let nothing else hold up the stream for long: no thread, no import, no search for garbage among the imports."""
    from hgma_compensation.kalman.low_pass import LFILTER  # which loads numpy

    LFILTER.wait = False
    sys.setswitchinterval(GIVE_WAY)
    gc.freeze()
    gc.enable()
