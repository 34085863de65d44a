"""Tables on standard output."""

from collections.abc import Sequence

import click
from rich import box
from rich.console import Console, ConsoleDimensions
from rich.table import Table
from rich.text import Text

from hgma_compensation.quantities import UNKNOWN

REDIRECTED_WIDTH = 150
"""Characters: where output goes to a file, a table is not folded to a terminal's 80."""


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
