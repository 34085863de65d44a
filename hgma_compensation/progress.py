"""Telling a progress bar how far a loop has come."""

from collections.abc import Callable, Iterable, Iterator
from typing import TypeVar

Advance = Callable[[int], None]
"""Called with the number of steps done since the last call."""

Item = TypeVar("Item")


def counted(items: Iterable[Item], advance: Advance | None, every: int = 1000) -> Iterator[Item]:
    """Yield the items, and after each ``every`` of them tell how many were done."""
    for count, item in enumerate(items, start=1):
        yield item
        if advance is not None and count % every == 0:
            advance(every)
