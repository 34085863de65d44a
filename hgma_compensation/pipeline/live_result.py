"""What became of samples in a node, and under which calibration."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.pipeline.cell_values import Cell
from hgma_compensation.pipeline.compensated import Compensated
from hgma_compensation.pipeline.pipeline import Pipeline


@dataclass(frozen=True)
class LiveResult:
    """What became of the samples, and under which calibration; every sample of it belongs to that one."""

    calibration: Calibration
    compensated: Compensated


@dataclass
class BlockEnd:
    """The last sample of a block that was taken as a whole, at a stamp in ns; its result is made when asked for."""

    pipeline: Pipeline
    stamp: int
    cell: Cell
    left: list[float]

    @cached_property
    def result(self) -> LiveResult:
        """The result (n = 1)."""
        stamps = np.array([self.stamp], dtype=np.int64)
        result = self.pipeline.ends_of_blocks(stamps, [self.cell], np.array([self.left]))
        return LiveResult(self.pipeline.calibration, result)

    @property
    def ordinary(self) -> bool:
        """Whether the temperature is what the calibration knows."""
        return not self.cell.status

    @property
    def features(self) -> NDArray[np.float64]:
        """Features (1, 3) before clamping."""
        return self.result.compensated.features
