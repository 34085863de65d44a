"""What the commands show: progress bars, tables, and the same figures as JSON."""

import json
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from hgma_compensation.errors import RefusedError
from hgma_compensation.files import write_atomically

REDIRECTED_WIDTH = 150
"""Characters: where output goes to a file, a table is not folded to a terminal's 80."""

console = Console(width=None if sys.stdout.isatty() else REDIRECTED_WIDTH)
_errors = Console(stderr=True)

Advance = Callable[[int], None]


@contextmanager
def progress_bar(text: str, total: float | None = None) -> Iterator[tuple[Progress, Any]]:
    """Show a bar on standard error while the block runs; it leaves nothing behind."""
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.percentage:>3.0f} %"),
        TimeElapsedColumn(),
    )
    with Progress(*columns, console=_errors, transient=True, disable=not _errors.is_terminal) as progress:
        yield progress, progress.add_task(text, total=total)


@contextmanager
def counting_bar(text: str, total: float | None = None) -> Iterator[Advance]:
    """Show a bar and give the function that moves it by a number of steps."""
    with progress_bar(text, total) as (progress, task):
        yield lambda steps: progress.advance(task, steps)


def check_new(path: Path) -> None:
    """Raise RefusedError, before any work is done, where an output would overwrite a bag or has no folder."""
    if path.exists():
        raise RefusedError(f"{path} exists: choose another name or remove it")
    check_folder(path)


def check_folder(path: Path) -> None:
    """Raise RefusedError where the folder that a file is to be written to does not exist."""
    if not path.parent.is_dir():
        raise RefusedError(f"{path.parent} is no directory: create it first")
    if path.is_dir():
        raise RefusedError(f"{path} is a directory: give the name of a file")


def write_json(path: Path | None, figures: dict[str, Any]) -> None:
    """Write the figures of a command, if it was asked to."""
    if path is not None:
        write_atomically(path, (json.dumps(figures, indent=1, allow_nan=False) + "\n").encode())
