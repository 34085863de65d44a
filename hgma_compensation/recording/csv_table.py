"""A recording out of a table of numbers."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import ceil
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.channels import CHANNELS
from hgma_compensation.errors import RefusedError
from hgma_compensation.progress import Advance
from hgma_compensation.quantities import STANDARD_GRAVITY as STANDARD_GRAVITY
from hgma_compensation.recording.csv_columns import read_columns
from hgma_compensation.recording.recording import Recording, Series
from hgma_compensation.stamps import NANOSECONDS

TIME_UNITS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
ACCELERATION_UNITS = {
    "m/s^2": 1.0,
    "g": STANDARD_GRAVITY,
    "mg": 1e-3 * STANDARD_GRAVITY,
    "kg": 1e3 * STANDARD_GRAVITY,
}
"""Factors to m/s²; "kg" is the kilo-g of shock tables."""
RATE_UNITS = {"rad/s": 1.0, "deg/s": float(np.pi / 180.0)}
LATEST = 2.0**31
"""s: what a stamp of ROS can hold."""

TEMPERATURE_UNITS = {"C": (1.0, 0.0), "K": (1.0, -273.15), "F": (5.0 / 9.0, -160.0 / 9.0)}
"""Factor and offset to °C."""


@dataclass(frozen=True)
class Columns:
    """Which columns of the table hold what: a header name, or a number counted from 1.

    channels: column of each channel that the table has. start, end: keep rows with start <= time < end,
    in s on the time column's own scale. skip_rows: data rows to leave out at the beginning. only: a column, and the
    number that it holds in the rows of this sensor; None where all rows are.
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
    only: tuple[str, float] | None = None
    frame: str = field(default="imu_link")


def read_table(path: Path, columns: Columns, progress: Advance | None = None) -> Recording:
    """Return the recording in a CSV file; progress: told of bytes read.

    Raises RefusedError naming the line and column of what is no number, and where time does not increase.
    """
    if not columns.channels:
        raise RefusedError("no channel is named: give at least one of --linear-acceleration-z COLUMN and its kind")
    table = _read_columns(Path(path), columns, progress)
    seconds = table["time"] * TIME_UNITS[columns.time_unit]
    shift = _to_positive(seconds)
    inside = (seconds >= (-np.inf if columns.start is None else columns.start)) & (
        seconds < (np.inf if columns.end is None else columns.end)
    )
    if inside.sum() < 2:
        raise RefusedError(
            f"{path} has {inside.sum()} rows between --from and --until: "
            f"its time runs from {seconds[0]:g} s to {seconds[-1]:g} s"
        )
    table, seconds = {name: numbers[inside] for name, numbers in table.items()}, seconds[inside]
    if np.abs(seconds).max() > LATEST:
        raise RefusedError(f"{path}: its time goes beyond {LATEST:g} s: name the time column and its unit")
    stamps = np.rint(seconds * NANOSECONDS).astype(np.int64) + shift
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


def _to_positive(seconds: NDArray[np.float64]) -> int:
    """Return by how much (ns) the stamps of a table are moved: a stamp of 0 says in ROS that there is none."""
    first = float(seconds.min(initial=np.inf))
    return NANOSECONDS * ceil(1.0 - first) if first <= 0.0 else 0


def _check_increasing(path: Path, stamps: NDArray[np.int64]) -> None:
    back = np.flatnonzero(np.diff(stamps) <= 0)
    if len(back):
        raise RefusedError(
            f"{path}: time does not increase at data row {back[0] + 2}: "
            "sort the table, or name the time column and its unit"
        )


def _rows_of(
    path: Path, table: dict[str, NDArray[np.float64]], column: str, number: float
) -> dict[str, NDArray[np.float64]]:
    """Return the rows in which a column, read as "only", holds a number; raises RefusedError where none does."""
    sensors = table.pop("only")
    rows = sensors == number
    if len(sensors) and not rows.any():
        held = ", ".join(f"{value:g}" for value in np.unique(sensors)[:10])
        raise RefusedError(f"{path} has no row with {number:g} in column {column!r}: it has {held}, choose another one")
    return {name: numbers[rows] for name, numbers in table.items()}


def _read_columns(path: Path, columns: Columns, progress: Advance | None) -> dict[str, NDArray[np.float64]]:
    wanted = {"time": columns.time, "temperature": columns.temperature, **columns.channels}
    for name in ("temperature_2", "supply_voltage"):
        column = getattr(columns, name)
        if column is not None:
            wanted[name] = column
    if columns.only is not None:
        wanted["only"] = columns.only[0]
    table = read_columns(path, wanted, skip_rows=columns.skip_rows, progress=progress)
    if columns.only is not None:
        table = _rows_of(path, table, *columns.only)
    if (rows := len(table["time"])) < 2:
        raise RefusedError(
            f"{path} has {rows} data rows after --skip-rows {columns.skip_rows}: a recording needs two or more"
        )
    return table
