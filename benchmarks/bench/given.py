"""What every group of rows is given."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from benchmarks.bench.calibrations import Calibrations


@dataclass(frozen=True)
class Given:
    """bags: folder of recordings that are kept. scratch: folder that goes with the run. say: tells how far it is."""

    repetitions: int
    bags: Path
    scratch: Path
    calibrations: Calibrations
    say: Callable[[str], None]
