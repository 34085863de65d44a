"""Serialised messages of a header and a few doubles: sensor_msgs/Temperature and hgma_msgs/SupplyVoltage."""

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.cdr.header import aligned, read_header, read_stamps
from hgma_compensation.cdr.rows import FLOAT64, fields
from hgma_compensation.stamps import Stamps

TEMPERATURE_DOUBLES = 2  # temperature, variance
SUPPLY_VOLTAGE_DOUBLES = 1


def scalar_columns(rows: NDArray[np.uint8], doubles: int) -> tuple[Stamps, NDArray[np.float64]] | None:
    """Return the stamps (n,) in ns and the first double (n,) after the header of messages (n, size).

    Args:
        rows: Messages of one topic, of equal length.
        doubles: How many doubles the type has after its header.

    Returns:
        None where the layout is not recognised, or the messages do not all have the same frame.
    """
    header = read_header(rows[0].data) if len(rows) else None
    if header is None or not header.begins_all(rows):
        return None
    start = aligned(header.end)
    if rows.shape[1] != start + doubles * FLOAT64.itemsize:
        return None
    values = fields(rows, start, start + FLOAT64.itemsize, FLOAT64)
    return read_stamps(rows), values[:, 0].astype(np.float64)
