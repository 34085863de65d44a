"""The life of the node's process: start, spin, end."""

import gc
import sys
import threading
import traceback
from collections.abc import Sequence

import rclpy
from rclpy.exceptions import ParameterException
from rclpy.executors import ExternalShutdownException
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.signals import SignalHandlerOptions

from hgma_compensation.errors import RefusedError
from hgma_compensation.node.compensation_node import CompensationNode
from hgma_compensation.node.managed_node import described
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
        node = _create()
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


def _create() -> CompensationNode:
    try:
        return CompensationNode()
    except (ParameterException, rclpy_implementation.RCLError) as error:
        raise RefusedError(f"parameters: {_cause(error)}") from error


def _cause(error: Exception) -> str:
    """Return what rcl says without the places in its source, which it appends."""
    return str(error).partition(", at /")[0].strip()


def _spin(node: CompensationNode, executor: WaitingExecutor, stop: threading.Event) -> int:
    """Serve samples and callbacks, all in this thread; an exception is a defect of this program, and ends it.

    What a half-finished callback leaves of filter and memories is unknown, and output computed from it would look like
    any other: whoever started the process sees it fail, and starts it anew from a known state.
    """
    try:
        node.start()
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
        node.get_logger().fatal(f"internal error, the node ends: {described(error)}\n{traceback.format_exc()}")
        return FAILED
    return 0


def share_interpreter() -> None:
    """Let no other thread, and no search for garbage among all that was imported, hold up the stream for long."""
    sys.setswitchinterval(GIVE_WAY)
    gc.collect()
    gc.freeze()
