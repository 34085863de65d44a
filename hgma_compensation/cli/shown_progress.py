"""Progress bars on a terminal; loaded only where there is one."""

from collections.abc import Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import (
    BarColumn,
    Progress,
    ProgressColumn,
    Task,
    TaskID,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)
from rich.text import Text


class _Share(ProgressColumn):
    """Per cent done, or the number of steps where nobody knows of how many."""

    def render(self, task: Task) -> Text:
        """Return the text of a task."""
        if task.total is None:
            return Text(f"{task.completed:,.0f}".replace(",", " ") if task.completed else "")
        return Text(f"{task.percentage:>3.0f} %")


@contextmanager
def shown_bar(text: str, total: float | None) -> Iterator[tuple[Progress, TaskID]]:
    """Show a bar on standard error while the block runs; it leaves nothing behind."""
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        _Share(),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    errors = Console(stderr=True)
    with Progress(*columns, console=errors, transient=True, disable=not errors.is_terminal) as progress:
        yield progress, progress.add_task(text, total=total)
