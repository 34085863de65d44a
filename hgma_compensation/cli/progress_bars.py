"""Progress bars on standard error."""

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

Advance = Callable[[int], None]

TERMINAL_ANYWAY = ("FORCE_COLOR", "TTY_COMPATIBLE")
"""Variables by which rich takes a file for a terminal."""


class Hidden:
    """A bar that nobody sees: one in a file would only be in the way, and what draws it takes its time to load."""

    def update(self, task: Any, **changes: Any) -> None:
        """Take what rich's Progress takes."""

    def advance(self, task: Any, steps: float = 1) -> None:
        """Take what rich's Progress takes."""


@contextmanager
def progress_bar(text: str, total: float | None = None) -> Iterator[tuple[Any, Any]]:
    """Show a bar while the block runs, and give rich's Progress, or a stand-in, and the task in it."""
    if not (sys.stderr.isatty() or any(name in os.environ for name in TERMINAL_ANYWAY)):
        yield Hidden(), None
        return
    from hgma_compensation.cli.shown_progress import shown_bar

    with shown_bar(text, total) as shown:
        yield shown


@contextmanager
def counting_bar(text: str, total: float | None = None) -> Iterator[Advance]:
    """Show a bar and give the function that moves it by a number of steps."""
    with progress_bar(text, total) as (progress, task):
        yield lambda steps: progress.advance(task, steps)
