"""What the commands show: progress bars, tables, and the same figures as JSON."""

import json
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, redirect_stdout
from pathlib import Path
from typing import Any, TextIO

import click
from rich import box
from rich.console import Console, ConsoleDimensions
from rich.progress import BarColumn, Progress, ProgressColumn, Task, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from rich.table import Table
from rich.text import Text

from hgma_compensation.cli import outputs
from hgma_compensation.errors import RefusedError
from hgma_compensation.files import check_regular, write_atomically
from hgma_compensation.quantities import UNKNOWN

REDIRECTED_WIDTH = 150
"""Characters: where output goes to a file, a table is not folded to a terminal's 80."""

STANDARD_OUTPUT = Path("-")
"""As the FILE of --json: standard output, which then holds nothing else."""

_STREAM = "hgma_compensation.standard_output"


class _TableConsole(Console):
    """A console as wide as the terminal, or as tables need where the output goes elsewhere."""

    @property
    def size(self) -> ConsoleDimensions:
        """Columns and rows; asked for at each table, since --json - moves what is shown to standard error."""
        size = super().size
        return size if self.is_terminal else ConsoleDimensions(max(size.width, REDIRECTED_WIDTH), size.height)

    @size.setter
    def size(self, new_size: tuple[int, int]) -> None:
        self._width, self._height = new_size


console = _TableConsole()
_errors = Console(stderr=True)

Advance = Callable[[int], None]


class _Share(ProgressColumn):
    """Per cent done, or the number of steps where nobody knows of how many."""

    def render(self, task: Task) -> Text:
        """Return the text of a task."""
        if task.total is None:
            return Text(f"{task.completed:,.0f}".replace(",", " ") if task.completed else "")
        return Text(f"{task.percentage:>3.0f} %")


@contextmanager
def progress_bar(text: str, total: float | None = None) -> Iterator[tuple[Progress, Any]]:
    """Show a bar on standard error while the block runs; it leaves nothing behind, and is not shown in a file."""
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        _Share(),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=_errors, transient=True, disable=not _errors.is_terminal) as progress:
        yield progress, progress.add_task(text, total=total)


@contextmanager
def counting_bar(text: str, total: float | None = None) -> Iterator[Advance]:
    """Show a bar and give the function that moves it by a number of steps."""
    with progress_bar(text, total) as (progress, task):
        yield lambda steps: progress.advance(task, steps)


def new_table(title: str, headings: Sequence[str], numbers: Sequence[str] = ()) -> Table:
    """Return an empty table with these headings; columns of numbers stand to the right.

    Narrow, so that four columns fit into 80 characters. Numbers and the first column, which names the row, are not cut.
    """
    # A name may hold brackets, which are markup in a plain string.
    table = Table(title=Text(title), title_justify="left", box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0), pad_edge=False)
    for place, heading in enumerate(headings):
        whole = place == 0 or heading in numbers
        table.add_column(heading, justify="right" if heading in numbers else "left", no_wrap=whole, overflow="fold")
    return table


def show_table(table: Table, why_unknown: str) -> None:
    """Print a table; where it holds "-", ``why_unknown`` says below what that means."""
    console.print(table)
    if any(str(cell) == UNKNOWN for column in table.columns for cell in column.cells):
        click.echo(f"{UNKNOWN}: {why_unknown}")


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
    if path == STANDARD_OUTPUT:
        raise RefusedError(f"{path} is no name of a file: only --json takes it, for standard output")
    check_regular(path)
    outputs.announce(path)


@contextmanager
def figures_to(path: Path | None) -> Iterator[None]:
    """Prepare for ``write_json`` while a command runs: to standard output, people's text goes to standard error.

    Raises RefusedError, before any work is done, where the file cannot be written.
    """
    if path == STANDARD_OUTPUT:
        click.get_current_context().meta[_STREAM] = sys.stdout
        with redirect_stdout(sys.stderr):
            yield
        return
    if path is not None:
        check_folder(path)
    yield


def write_json(path: Path | None, figures: dict[str, Any]) -> None:
    """Write the figures of a command, if it was asked to; to standard output where the path is "-"."""
    if path is None:
        return
    text = json.dumps(figures, indent=1, allow_nan=False) + "\n"
    if path == STANDARD_OUTPUT:
        stream: TextIO = click.get_current_context().meta.get(_STREAM) or sys.stdout
        stream.write(text)
        stream.flush()
    else:
        write_atomically(path, text.encode())
