"""Work that one thread does in the order in which it is given, while the next is prepared."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any


class InTurn:
    """A thread with a queue of bounded length; to be closed."""

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
