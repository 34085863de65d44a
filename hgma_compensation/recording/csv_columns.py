"""Columns of numbers out of a CSV file, row by row, so that only the numbers are held."""

import csv
import io
from array import array
from collections.abc import Mapping, Sequence
from math import isfinite
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.bounded_files import lines_of, open_regular
from hgma_compensation.errors import RefusedError
from hgma_compensation.progress import Advance

MOST_ROWS = 200_000_000
"""Two days at 1 kHz."""

TOLD_EVERY = 10_000
"""Rows."""

ROW_REMEDY = "remove the row, or leave rows out at the beginning with --skip-rows"


def read_columns(
    path: Path,
    columns: Mapping[str, str],
    *,
    skip_rows: int = 0,
    most_rows: int = MOST_ROWS,
    remedy: str = ROW_REMEDY,
    progress: Advance | None = None,
) -> dict[str, NDArray[np.float64]]:
    """Return the columns (n,) under the names of the mapping, whose values are header names or numbers from 1 on.

    skip_rows: data rows to leave out at the beginning; rows without a field do not count. progress: told of
    bytes read. Raises RefusedError naming
    the line and column of what is no finite number, a column that is missing, and a file that is no table.
    """
    try:
        with open_regular(path) as file, io.TextIOWrapper(file, encoding="utf-8-sig", newline="") as text:
            reader = csv.reader(lines_of(text, path))
            header = next(reader, None)
            if header is None:
                raise RefusedError(f"{path} is empty: give a table with a header line")
            names = [name.strip() for name in header]
            places = [_place(path, names, column) for column in columns.values()]
            numbers = [array("d") for _ in places]
            told = 0
            for index, row in enumerate(reader):
                if progress is not None and index % TOLD_EVERY == 0:
                    progress(file.tell() - told)
                    told = file.tell()
                if index < skip_rows or not row:
                    continue
                _append(path, reader.line_num, row, places, numbers, names, remedy)
                if len(numbers[0]) > most_rows:
                    raise RefusedError(f"{path} has more than {most_rows} rows: cut it into parts")
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise RefusedError(
            f"{path} cannot be read as a CSV table ({error}): save it as UTF-8 text with commas"
        ) from None
    return {name: np.frombuffer(column, dtype=np.float64) for name, column in zip(columns, numbers, strict=True)}


def _place(path: Path, names: list[str], column: str) -> int:
    if column in names:
        return names.index(column)
    if column.isdecimal() and len(column) < 10 and 1 <= int(column) <= len(names):
        return int(column) - 1
    raise RefusedError(f"{path} has no column {column!r}: it has {', '.join(names)}; give one of them")


def _append(
    path: Path,
    line: int,
    row: Sequence[str],
    places: Sequence[int],
    numbers: Sequence["array[float]"],
    names: Sequence[str],
    remedy: str,
) -> None:
    for place, column in zip(places, numbers, strict=True):
        try:
            value = float(row[place])
        except (ValueError, IndexError):
            value = float("nan")
        if not isfinite(value):
            raise RefusedError(f"{path}, line {line}: column {names[place]!r} holds no finite number: {remedy}")
        column.append(value)
