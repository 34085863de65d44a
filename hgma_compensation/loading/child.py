"""The loading process: answers one request after the other until its standard input is closed."""

import os
import sys
from typing import BinaryIO, cast

from hgma_compensation.loading.frames import framed, read_frame
from hgma_compensation.loading.job import Request, answer


def main() -> int:
    """Serve the process that started this one, and end with it, however it ends; return the exit code."""
    # So that the request which wakes this process does not take the core from its parent, in the midst of a stream.
    os.sched_setscheduler(0, os.SCHED_BATCH, os.sched_param(0))
    answers = _take_standard_output()
    try:
        while True:
            answers.write(framed(answer(cast(Request, read_frame(sys.stdin.buffer)))))
    except (EOFError, BrokenPipeError):
        return 0


def _take_standard_output() -> BinaryIO:
    """Return the pipe that standard output was; whatever prints from now on, prints to standard error."""
    pipe = os.fdopen(os.dup(1), "wb", buffering=0)
    os.dup2(2, 1)
    return cast(BinaryIO, pipe)
