"""A measured acceleration out of a CSV table, such as a drop-tower shock."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.errors import RefusedError
from hgma_compensation.recording.csv_columns import read_columns
from hgma_compensation.recording.csv_table import ACCELERATION_UNITS, TIME_UNITS

Array = NDArray[np.float64]
MOST_ROWS = 5_000_000
"""Five seconds of a waveform at 1 MHz."""


def read_waveform(path: Path, time_column: str, column: str, time_unit: str, unit: str) -> tuple[Array, Array]:
    """Return times (k,) in s, from 0 on, and accelerations (k,) in m/s².

    Raises RefusedError naming the file and the column that is missing or no number.
    """
    columns = {"times": time_column, "values": column}
    read = read_columns(path, columns, most_rows=MOST_ROWS, remedy="remove the row")
    times, values = read["times"] * TIME_UNITS[time_unit], read["values"] * ACCELERATION_UNITS[unit]
    if len(times) < 2 or (np.diff(times) <= 0.0).any():
        raise RefusedError(f"{path}: column {time_column!r} must hold two or more times that increase")
    return times - times[0], values
