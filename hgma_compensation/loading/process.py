"""The loading process as its parent sees it: started early, replaced where it has ended or does not answer."""

import contextlib
import os
import subprocess
import sys
from collections.abc import Callable
from typing import cast

from hgma_compensation.errors import RefusedError
from hgma_compensation.loading.conversation import converse
from hgma_compensation.loading.frames import framed
from hgma_compensation.loading.job import Refusal, Request
from hgma_compensation.pipeline.pipeline import Pipeline

PATIENCE = 10.0
"""s after which a request is given up: a disk or network does not answer."""

CHILD = "import sys; sys.path[:] = sys.argv[1:]; from hgma_compensation.loading.child import main; sys.exit(main())"
"""Looks for modules where its parent does, and not in the working directory, where anything may lie."""

MOST_HANGING = 4
"""Processes that a disk holds although they were killed, beyond which no other is started."""

LAST_WAIT = 1.0
"""s that the end waits for the process to be gone."""


class LoadingProcess:
    """A child process that reads, validates and prepares calibrations; it ends with this process at the latest."""

    def __init__(self, patience: float | None = None) -> None:
        """Start it, so that the first request finds it ready; patience: s, None for PATIENCE."""
        self._patience = PATIENCE if patience is None else patience
        self._killed: list[subprocess.Popen[bytes]] = []
        self._child: subprocess.Popen[bytes] | None = None
        with contextlib.suppress(ChildProcessError):  # tried again at the first request
            self._child = _started()

    def ask(self, request: Request, serve: Callable[[], None]) -> Pipeline:
        """Return the pipeline of a calibration; ``serve`` is called in this thread until it is there.

        Raises RefusedError with the reason for which the calibration is refused, TimeoutError where there is no answer
        in time, ChildProcessError where the process cannot be started or ended twice.
        """
        try:
            answer = self._ask(framed(request), serve)
        except BaseException:
            # Its answer may still come, and must not be taken for that to the next request.
            self._kill()
            with contextlib.suppress(ChildProcessError):
                self._start()
            raise
        if isinstance(answer, Refusal):
            raise RefusedError(answer.reason)
        return cast(Pipeline, answer)

    def close(self) -> None:
        """End it."""
        self._kill()
        for child in self._killed:
            with contextlib.suppress(subprocess.TimeoutExpired):
                child.wait(LAST_WAIT)

    def _ask(self, frame: bytes, serve: Callable[[], None]) -> object:
        try:
            return converse(self._running(), frame, serve, self._patience)
        except EOFError:
            self._kill()  # Ended by somebody, or for its memory; by this very calibration only if it happens again.
        try:
            return converse(self._running(), frame, serve, self._patience)
        except EOFError:
            raise ChildProcessError("the process that reads it has ended, twice") from None

    def _running(self) -> "subprocess.Popen[bytes]":
        if self._child is None or not _lives(self._child):
            self._kill()
            self._start()
        assert self._child is not None
        return self._child

    def _start(self) -> None:
        self._killed = [child for child in self._killed if child.poll() is None]
        if len(self._killed) > MOST_HANGING:
            raise ChildProcessError("the processes that read those before still hang")
        self._child = _started()

    def _kill(self) -> None:
        if self._child is not None:
            self._child.kill()
            for pipe in (self._child.stdin, self._child.stdout):
                if pipe is not None:
                    pipe.close()
            self._killed.append(self._child)
            self._child = None


def _lives(child: "subprocess.Popen[bytes]") -> bool:
    return child.poll() is None


def _started() -> "subprocess.Popen[bytes]":
    """Return a new child; raises ChildProcessError where there can be none."""
    try:
        # In a session of its own: a Ctrl-C in the terminal is for the parent, which then ends the child. The
        # environment says already that ROS wheels have found their libraries, so that the interpreter starts once.
        child = subprocess.Popen(
            [sys.executable, "-c", CHILD, *sys.path],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            bufsize=0,
            start_new_session=True,
        )
    except OSError as error:
        raise ChildProcessError(f"the process that reads it cannot be started ({error.strerror})") from None
    for pipe in (child.stdin, child.stdout):
        assert pipe is not None
        os.set_blocking(pipe.fileno(), False)
    return child
