"""A recording out of a table of numbers."""

import csv
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.channels import CHANNELS
from hgma_compensation.errors import RefusedError
from hgma_compensation.recording.recording import Recording, Series
from hgma_compensation.stamps import NANOSECONDS

STANDARD_GRAVITY = 9.80665
TIME_UNITS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
ACCELERATION_UNITS = {
    "m/s^2": 1.0,
    "g": STANDARD_GRAVITY,
    "mg": 1e-3 * STANDARD_GRAVITY,
    "kg": 1e3 * STANDARD_GRAVITY,
}
"""Factors to m/s²; "kg" is the kilo-g of shock tables."""
RATE_UNITS = {"rad/s": 1.0, "deg/s": float(np.pi / 180.0)}
TEMPERATURE_UNITS = {"C": (1.0, 0.0), "K": (1.0, -273.15), "F": (5.0 / 9.0, -160.0 / 9.0)}
"""Factor and offset to °C."""


@dataclass(frozen=True)
class Columns:
    """Which columns of the table hold what: a header name, or a number counted from 1.

    channels: column of each channel that the table has. start, end: keep rows with start <= time < end,
    in s on the time column's own scale. skip_rows: data rows to leave out at the beginning.
    """

    time: str
    temperature: str
    channels: Mapping[str, str]
    temperature_2: str | None = None
    supply_voltage: str | None = None
    time_unit: str = "s"
    acceleration_unit: str = "m/s^2"
    rate_unit: str = "rad/s"
    temperature_unit: str = "C"
    start: float | None = None
    end: float | None = None
    skip_rows: int = 0
    frame: str = field(default="imu_link")


def read_table(path: Path, columns: Columns) -> Recording:
    """Return the recording in a CSV file.

    Raises RefusedError naming the line and column of what is no number, and where time does not increase.
    """
    if not columns.channels:
        raise RefusedError("no channel is named: give at least one of --linear-acceleration-z COLUMN and its kind")
    table = _read_columns(Path(path), columns)
    seconds = table["time"] * TIME_UNITS[columns.time_unit]
    inside = (seconds >= (-np.inf if columns.start is None else columns.start)) & (
        seconds < (np.inf if columns.end is None else columns.end)
    )
    if inside.sum() < 2:
        raise RefusedError(
            f"{path} has {inside.sum()} rows between --from and --until: "
            f"its time runs from {seconds[0]:g} s to {seconds[-1]:g} s"
        )
    table, seconds = {name: numbers[inside] for name, numbers in table.items()}, seconds[inside]
    stamps = np.rint(seconds * NANOSECONDS).astype(np.int64)
    _check_increasing(path, stamps)
    factor, offset = TEMPERATURE_UNITS[columns.temperature_unit]
    values = np.zeros((len(stamps), len(CHANNELS)))
    for channel in columns.channels:
        rate = channel.startswith("angular")
        unit = RATE_UNITS[columns.rate_unit] if rate else ACCELERATION_UNITS[columns.acceleration_unit]
        values[:, CHANNELS.index(channel)] = table[channel] * unit

    def series(name: str, factor: float = 1.0, offset: float = 0.0) -> Series:
        return Series(stamps, table[name] * factor + offset) if name in table else Series.empty()

    return Recording(
        name=Path(path).stem,
        stamps=stamps,
        values=values,
        present=tuple(channel for channel in CHANNELS if channel in columns.channels),
        temperature=series("temperature", factor, offset),
        temperature_2=series("temperature_2", factor, offset),
        supply_voltage=series("supply_voltage"),
        frame=columns.frame,
    )


def _check_increasing(path: Path, stamps: NDArray[np.int64]) -> None:
    back = np.flatnonzero(np.diff(stamps) <= 0)
    if len(back):
        raise RefusedError(
            f"{path}: time does not increase at data row {back[0] + 2}: "
            "sort the table, or name the time column and its unit"
        )


def _read_columns(path: Path, columns: Columns) -> dict[str, NDArray[np.float64]]:
    wanted = {"time": columns.time, "temperature": columns.temperature, **columns.channels}
    for name in ("temperature_2", "supply_voltage"):
        column = getattr(columns, name)
        if column is not None:
            wanted[name] = column
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            reader = csv.reader(file)
            header = next(reader, None)
            if header is None:
                raise RefusedError(f"{path} is empty")
            places = {name: _place(path, header, column) for name, column in wanted.items()}
            rows = list(reader)[columns.skip_rows :]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise RefusedError(f"{path} cannot be read as a CSV table ({error})") from None
    rows = [row for row in rows if row]
    if len(rows) < 2:
        raise RefusedError(
            f"{path} has {len(rows)} data rows after --skip-rows {columns.skip_rows}: a recording needs two or more"
        )
    return {name: _numbers(path, rows, place, header, columns.skip_rows) for name, place in places.items()}


def _place(path: Path, header: list[str], column: str) -> int:
    names = [name.strip() for name in header]
    if column in names:
        return names.index(column)
    if column.isdigit() and 1 <= int(column) <= len(names):
        return int(column) - 1
    raise RefusedError(f"{path} has no column {column!r}: it has {', '.join(names)}")


def _numbers(path: Path, rows: list[list[str]], place: int, header: list[str], skipped: int) -> NDArray[np.float64]:
    try:
        numbers = np.array([row[place] for row in rows], dtype=np.float64)
    except (ValueError, IndexError):
        numbers = np.array([_number(row[place]) if place < len(row) else np.nan for row in rows])
    bad = np.flatnonzero(~np.isfinite(numbers))
    if len(bad):
        # One line for the header, one because lines are counted from 1.
        line = int(bad[0]) + skipped + 2
        raise RefusedError(
            f"{path}, line {line}: column {header[place].strip()!r} holds no finite number: "
            "remove the row, or leave rows out at the beginning with --skip-rows"
        )
    return numbers


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return float("nan")
