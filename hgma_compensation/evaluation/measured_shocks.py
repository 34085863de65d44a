"""Measured drop-tower shocks, one row of the table taken as one sample at whatever rate is asked for."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.measured_data import measured_data
from hgma_compensation.recording.csv_table import STANDARD_GRAVITY

FILES = ("accel_1", "accel_5")
UNIT = "_kg"
"""Of the columns: thousands of g."""


def measured_shocks() -> dict[str, NDArray[np.float64]]:
    """Return the shocks (n,) in m/s² by file and test, none where the measured data is not present."""
    folder = measured_data()
    shocks: dict[str, NDArray[np.float64]] = {}
    for name in FILES if folder else ():
        assert folder is not None
        path = folder / "drop_tower_shock" / f"{name}.csv"
        if path.is_file():
            shocks |= {f"{name} {test}": values for test, values in _read(path).items()}
    return shocks


def _read(path: Path) -> dict[str, NDArray[np.float64]]:
    table = np.genfromtxt(path, delimiter=",", names=True)
    tests = [name for name in table.dtype.names or () if name.endswith(UNIT)]
    return {name.removesuffix(UNIT): table[name] * 1e3 * STANDARD_GRAVITY for name in tests}
