"""A measured acceleration out of a CSV table, such as a drop-tower shock."""

import csv
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.errors import RefusedError
from hgma_compensation.recording.csv_table import ACCELERATION_UNITS, TIME_UNITS

Array = NDArray[np.float64]
LARGEST_FILE = 100 << 20


def read_waveform(path: Path, time_column: str, column: str, time_unit: str, unit: str) -> tuple[Array, Array]:
    """Return times (k,) in s, from 0 on, and accelerations (k,) in m/s².

    Raises RefusedError naming the file and the column that is missing or no number.
    """
    try:
        if path.stat().st_size > LARGEST_FILE:
            raise RefusedError(f"{path} is larger than {LARGEST_FILE} bytes: cut it to the shock")
        with path.open(newline="", encoding="utf-8-sig") as file:
            header, *rows = list(csv.reader(file)) or [[]]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise RefusedError(f"{path} cannot be read as a CSV table ({error})") from None
    times = _numbers(path, header, rows, time_column) * TIME_UNITS[time_unit]
    values = _numbers(path, header, rows, column) * ACCELERATION_UNITS[unit]
    if len(times) < 2 or (np.diff(times) <= 0.0).any():
        raise RefusedError(f"{path}: column {time_column!r} must hold two or more times that increase")
    return times - times[0], values


def _numbers(path: Path, header: list[str], rows: list[list[str]], column: str) -> Array:
    names = [name.strip() for name in header]
    if column not in names:
        raise RefusedError(f"{path} has no column {column!r}: it has {', '.join(names)}")
    place = names.index(column)
    try:
        numbers = np.array([float(row[place]) for row in rows if row])
    except (ValueError, IndexError):
        raise RefusedError(f"{path}: column {column!r} holds something that is no number") from None
    if not np.isfinite(numbers).all():
        raise RefusedError(f"{path}: column {column!r} holds a number that is not finite")
    return numbers
