"""Saves states on a thread of its own, so that no sample waits for a disk."""

import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from threading import Thread

from hgma_compensation.errors import RefusedError
from hgma_compensation.pipeline.live_state import LiveState
from hgma_compensation.pipeline.state_file import check_replaceable, write_state

REST = 2e-4
"""s that the saving thread sleeps between two pieces of its work: it may hold the interpreter only briefly."""


class StateSaver:
    """One job at a time; what a slow disk has no time for is skipped, not queued. All calls come from one thread.

    saves, failures, skipped: counts. size: bytes of the file. saved_at: monotonic s of the last save. problem: why the
    last job failed, "" where it did not.
    """

    def __init__(self, path: Path) -> None:
        """Save to a path."""
        self._path = path
        self._job: Thread | None = None
        self._discard = False
        self.saves = self.failures = self.skipped = self.size = 0
        self.saved_at: float | None = None
        self.problem = ""

    @property
    def busy(self) -> bool:
        """Whether a job is under way."""
        return self._job is not None and self._job.is_alive()

    @property
    def discarding(self) -> bool:
        """Whether a file that counts no more could not be removed yet."""
        return self._discard

    def save(self, state: LiveState) -> bool:
        """Begin to save a state; return whether it was taken."""
        if self.busy:
            self.skipped += 1
            return False
        self._begin(partial(self._write, state))
        return True

    def discard(self) -> None:
        """Begin to remove the file, after the save that is under way."""
        self._discard = True
        self._begin(self._remove)

    def wait(self, timeout: float) -> bool:
        """Return whether the job was done within ``timeout`` s."""
        if self._job is not None:
            self._job.join(timeout)
        return not self.busy

    def _begin(self, work: Callable[[], None]) -> None:
        # A daemon: a disk that hangs must not keep the process from ending.
        self._job = Thread(target=self._run, args=(self._job, work), name="state_saver", daemon=True)
        self._job.start()

    def _run(self, before: Thread | None, work: Callable[[], None]) -> None:
        if before is not None:
            before.join()
        try:
            work()
            self.problem = ""
        except (RefusedError, OSError) as error:
            self.failures += 1
            self.problem = str(error)

    def _write(self, state: LiveState) -> None:
        self.size = write_state(state, self._path, partial(time.sleep, REST))
        self.saves += 1
        self.saved_at, self._discard = time.monotonic(), False

    def _remove(self) -> None:
        check_replaceable(self._path)
        try:
            self._path.unlink()
        except (FileNotFoundError, NotADirectoryError):
            pass  # there is none
        except OSError as error:
            raise RefusedError(
                f"{self._path} cannot be removed ({error.strerror}): remove it, or the next start takes it up"
            ) from None
        self._discard, self.size = False, 0
