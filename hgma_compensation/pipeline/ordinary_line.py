"""The line of one cell in plain numbers: all that a sample needs that does nothing but go on."""

from dataclasses import dataclass

from hgma_compensation.calibration.effect_encoding import LARGEST_ACCELERATION
from hgma_compensation.pipeline.cell_values import CellValues
from hgma_compensation.pipeline.inputs import Inputs


@dataclass(frozen=True)
class OrdinaryLine:
    """Drift of channels without Kalman stage or effects that each sample must be looked at for, in one cell.

    The same formula as ``SlowSamples``, in numbers: arrays of one sample cost ten times as much. inputs, version: what
    it was read from. begin, until: ns. columns: (c,) of CHANNELS. lines: (c,) first value and change over the cell.
    """

    inputs: Inputs
    version: int
    begin: int
    until: int
    inverse: float
    columns: tuple[int, ...]
    lines: tuple[tuple[float, float], ...]

    @classmethod
    def of(cls, inputs: Inputs, cell: CellValues, until: int, columns: list[int]) -> "OrdinaryLine | None":
        """Return the line of an ordinary cell (m = 1), None where its samples must be looked at."""
        if not cell.ordinary:
            return None
        first, change = cell.drift.first[0].tolist(), cell.drift.change[0].tolist()
        return cls(
            inputs,
            inputs.version,
            int(cell.begin[0]),
            until,
            float(cell.inverse[0]),
            tuple(columns),
            tuple(zip(first, change, strict=True)),
        )

    def holds(self, stamp: int, newest: int, inputs: Inputs) -> bool:
        """Return whether a sample at a stamp follows the newest one (ns) in the cell, the inputs being as they were."""
        return newest < stamp < self.until and inputs is self.inputs and inputs.version == self.version

    def compensated(self, stamp: int, values: tuple[float, ...]) -> list[float] | None:
        """Return the channels (c,) less their drift, values (6,) in the order of CHANNELS; None for a bad value."""
        way = (stamp - self.begin) * self.inverse
        found = []
        for column, (first, change) in zip(self.columns, self.lines, strict=True):
            value = values[column]
            if not -LARGEST_ACCELERATION <= value <= LARGEST_ACCELERATION:
                return None
            found.append(value - (first + way * change))
        return found
