"""Entry point of ``compensation_node`` and ``hgma node``; imports nothing of ROS before signals are caught."""

import gc
import signal
import sys
import threading
from collections.abc import Sequence

from hgma_compensation.errors import RefusedError

REFUSED = 2


def main(args: Sequence[str] | None = None) -> int:
    """Run the node until SIGINT, SIGTERM or a shutdown of ROS.

    Returns the exit code: 0 after such an end, 1 after an error of the program's own, 2 where the arguments or
    parameters are refused.
    """
    stop = stop_signals()
    # Loading makes objects and no garbage: to search among them again and again would delay the start. See
    # share_interpreter, which allows it again.
    gc.disable()
    try:
        return _run(list(args) if args is not None else sys.argv, stop)
    except RefusedError as refusal:
        print(f"error: {refusal}", file=sys.stderr)
        return REFUSED
    finally:
        # A second Ctrl-C must not cut off what the middleware does after the last line of Python.
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, signal.SIG_IGN)


def stop_signals() -> threading.Event:
    """Return an event that SIGINT and SIGTERM set from now on."""
    stop = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: stop.set())
    return stop


def _run(args: list[str], stop: threading.Event) -> int:
    # Loading ROS takes most of a second, in which a signal must already end the process cleanly.
    try:
        from hgma_compensation.node.running import run
    except ImportError as error:
        raise RefusedError(f"ROS is not installed ({error}): run make, or source your ROS 2 workspace") from error
    return run(args, stop)


if __name__ == "__main__":
    sys.exit(main())
