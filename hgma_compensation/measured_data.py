"""Measured recordings that live outside of the project."""

import os
from pathlib import Path

VARIABLE = "HGMA_MEASURED_DATA"

CHAMBER_SPLIT = 3128.0
"""s: top of the heating in the chamber recording; the cooling after it is held out."""

CHAMBER_OUTLIERS = 5
"""Rows at the start of that file that are a start-up outlier, as its description says."""


def measured_data() -> Path | None:
    """Return the folder of measured data, None where there is none.

    It is the one that HGMA_MEASURED_DATA names, else shared/data beside the checkout.
    """
    named = os.environ.get(VARIABLE)
    folder = Path(named) if named else Path(__file__).parents[2] / "shared" / "data"
    return folder if folder.is_dir() else None


def chamber_table() -> Path | None:
    """Return the recording of a drone's IMU in a thermal chamber, None where it is not there."""
    folder = measured_data()
    table = folder / "chamber_imu" / "chamber_imu.csv" if folder else None
    return table if table and table.is_file() else None
