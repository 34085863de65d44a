"""Telling a progress bar how far a loop has come."""

from collections.abc import Callable, Iterable, Iterator
from typing import TypeVar

Advance = Callable[[int], None]
"""Called with the number of steps done since the last call."""

Item = TypeVar("Item")


def counted(items: Iterable[Item], advance: Advance | None, every: int = 1000) -> Iterator[Item]:
    """Yield the items, and after each ``every`` of them, and at the end, tell how many were done.

    The end may be an exception, such as an interruption.
    """
    told = done = 0
    try:
        for done, item in enumerate(items, start=1):
            yield item
            if advance is not None and done - told == every:
                advance(every)
                told = done
    finally:
        if advance is not None and done > told:
            advance(done - told)
