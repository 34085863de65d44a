"""Work that one thread does in the order in which it is given, while the next is prepared."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from types import TracebackType
from typing import Any


class InTurn:
    """A thread with a queue of bounded length; a context, which is left when all is done or given up."""

    def __init__(self, most: int) -> None:
        """Let so many calls wait: what they were given is held."""
        self._most = most
        self._thread = ThreadPoolExecutor(1)
        self._waiting: deque[Future[Any]] = deque()

    def submit(self, call: Callable[..., Any], *arguments: Any) -> None:
        """Have a function called; raises what an earlier call raised."""
        self.wait(self._most)
        self._waiting.append(self._thread.submit(call, *arguments))

    def wait(self, left: int = 0) -> None:
        """Wait until so many calls are left at the most; raises what one raised."""
        while len(self._waiting) > left:
            self._waiting.popleft().result()

    def close(self) -> None:
        """End the thread after the call that it is at; what still waits is given up."""
        self._thread.shutdown(cancel_futures=True)

    def __enter__(self) -> InTurn:
        """Begin."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        """Wait for all where nothing was raised, and end the thread."""
        try:
            if kind is None:
                self.wait()
        finally:
            self.close()
