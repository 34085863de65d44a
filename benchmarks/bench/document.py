"""The generated part of docs/PERFORMANCE.md."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from benchmarks.bench.row import Row
from benchmarks.bench.table import markdown_table
from hgma_compensation.files import write_atomically

BEGIN, END = "<!-- begin: written by make bench -->", "<!-- end: written by make bench -->"


def generated(rows: Sequence[Row], machine: Mapping[str, str]) -> str:
    """Return the table and what it was measured on, as markdown."""
    lines = "".join(f"| {name} | {value} |\n" for name, value in machine.items())
    return f"{markdown_table(rows)}\n| measured on | |\n| --- | --- |\n{lines}"


def with_generated(text: str, part: str) -> str:
    """Return a document with the part between its marks replaced; raises ValueError where it has not both, once."""
    before, begin, rest = text.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not begin or not end or BEGIN in rest or END in after:
        raise ValueError(f"needs {BEGIN} and {END}, once each and in this order")
    return f"{before}{BEGIN}\n\n{part.strip()}\n\n{END}{after}"


def update(path: Path, rows: Sequence[Row], machine: Mapping[str, str]) -> None:
    """Write the generated part into a document."""
    text = with_generated(path.read_text(encoding="utf-8"), generated(rows, machine))
    write_atomically(path, text.encode())
