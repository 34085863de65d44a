"""The rows as one table, for the terminal and as markdown."""

from collections.abc import Sequence
from statistics import median

from rich.table import Table

from benchmarks.bench.row import Row

HEADINGS = ("what", "unit", "ours", "rival", "rival is", "ratio (min to max)", "target", "")


def cells(row: Row) -> tuple[str, ...]:
    """Return a row's cells, medians of both sides and the ratio with its spread."""
    ratios = row.ratios
    ratio = f"{number(row.ratio)} ({number(min(ratios))} to {number(max(ratios))})"
    target = "" if row.target is None else str(row.target)
    name = f"{row.name} [{row.note}]" if row.note else row.name
    sides = (number(median(row.ours)), number(median(row.rival)))
    return (f"{row.group}: {name}", row.unit, *sides, row.rival_name, ratio, target, row.verdict)


def number(value: float) -> str:
    """Return three significant digits, without an exponent where that is readable."""
    if value == 0.0 or not 1e-3 <= abs(value) < 1e7:
        return f"{value:.3g}"
    digits = f"{value:.3g}"
    return digits if "e" not in digits else f"{float(digits):.0f}"


def terminal_table(rows: Sequence[Row]) -> Table:
    """Return the table for a terminal."""
    table = Table()
    for place, heading in enumerate(HEADINGS):
        table.add_column(heading, justify="right" if heading in ("ours", "rival") else "left", no_wrap=place > 0)
    for row in rows:
        table.add_row(*(cell.replace("[", r"\[") for cell in cells(row)))
    return table


def markdown_table(rows: Sequence[Row]) -> str:
    """Return the table as markdown."""
    rules = ["---:" if heading in ("ours", "rival") else "---" for heading in HEADINGS]
    return "".join(f"| {' | '.join(line)} |\n" for line in (HEADINGS, rules, *map(cells, rows)))
