"""A request to a child process and its answer, while the caller goes on with what cannot wait."""

import os
import time
from collections.abc import Callable
from select import select
from subprocess import Popen

from hgma_compensation.loading.frames import Incoming

TURN = 0.0005
"""s between two turns of what cannot wait: half a sample at 1 kHz."""

PIECE = 1 << 16
"""Bytes that are read at once: what a pipe holds."""


def converse(child: "Popen[bytes]", frame: bytes, serve: Callable[[], None], patience: float) -> object:
    """Send a frame and return the object that is the answer, ``serve`` being called all the time.

    No thread: one would take the interpreter from ``serve``. The pipes do not block. Raises EOFError where the child
    has ended, TimeoutError where it has not answered within ``patience`` s.
    """
    assert child.stdin is not None
    assert child.stdout is not None
    sink, source = child.stdin.fileno(), child.stdout.fileno()
    unsent, incoming, end = memoryview(frame), Incoming(), time.monotonic() + patience
    while not incoming.complete:
        readable, writable, _ = select([source], [sink] if unsent else [], [], TURN)
        if writable:
            unsent = unsent[_write(sink, unsent) :]
        if readable:
            incoming.feed(_read(source))
        if time.monotonic() > end:
            raise TimeoutError(f"not done within {patience:g} s")
        serve()
    answer = incoming.message()
    serve()
    return answer


def _write(sink: int, content: memoryview) -> int:
    try:
        return os.write(sink, content)
    except BrokenPipeError:
        raise EOFError("the child has ended") from None


def _read(source: int) -> bytes:
    if not (piece := os.read(source, PIECE)):
        raise EOFError("the child has ended")
    return piece
