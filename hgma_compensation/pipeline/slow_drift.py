"""The drift that the slow inputs make, evaluated at both ends of cells: drift model and slow effects.

Between the ends it is a straight line. Nothing steps inside a cell, so that with h = STEP the line is off by at most
h²/8 times the greatest second derivative of the drift with time in it (the chord's bound; de Boor 2001, section III):
see docs/METHOD.md for its size.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.channels import CHANNELS
from hgma_compensation.effects.stage import EffectStage
from hgma_compensation.pipeline.cells import ALONE, STEP, Cells, Places, cells_of
from hgma_compensation.pipeline.inputs import Inputs
from hgma_compensation.pipeline.status import temperature_status
from hgma_compensation.stamps import Stamps
from hgma_compensation.temperature.features import read_features

Array = NDArray[np.float64]

MOST_CELLS = 4
"""Beyond that many, cells are evaluated together."""


@dataclass(frozen=True)
class Line:
    """Straight lines over m cells: value at the beginning of each and change until its end, (m, k)."""

    first: Array
    change: Array

    @classmethod
    def through(cls, ends: Array) -> "Line":
        """Return the lines through values (2m, k): those at all beginnings, then those at all ends."""
        first, last = np.split(ends, 2)
        return cls(first, last - first)


@dataclass(frozen=True)
class CellValues:
    """What holds in m cells.

    inverse: (m,) 1/ns, one over the length. features: before clamping, the middle of the calibrated range where the
    temperature is missing; k = 3. model, effects: k = c, drift of the model and that of the slow effects, if there are
    any. drift: both together; k = c. status,
    inside: (m,) at the beginning. mixed: (m,) whether status or range are others at the end, so that each sample must
    be looked at. age, since_power_on: (m,) s at the beginning. unusable, missing: (m,), the same all through a cell.
    """

    begin: Stamps
    inverse: Array
    features: Line
    model: Line
    effects: Line | None
    drift: Line
    status: NDArray[np.uint8]
    inside: NDArray[np.bool_]
    mixed: NDArray[np.bool_]
    age: Array
    since_power_on: Array
    unusable: NDArray[np.bool_]
    missing: NDArray[np.bool_]

    @cached_property
    def ordinary(self) -> bool:
        """Whether the temperature is what the calibration knows, in all cells and all through them."""
        return not (self.status.any() or self.mixed.any())


@dataclass(frozen=True)
class Cell:
    """One cell and its line in the form in which many samples are taken through it.

    begin: ns. inverse: 1/ns. first, change: (c, 1). largest_drift: the greatest there is of any channel, without sign.
    """

    values: CellValues
    begin: int
    inverse: float
    first: Array
    change: Array
    largest_drift: float

    @classmethod
    def of(cls, values: CellValues) -> "Cell":
        """Return the cell (m = 1)."""
        first, change = values.drift.first.T, values.drift.change.T
        largest = float(np.maximum(np.abs(first), np.abs(first + change)).max())
        return cls(values, int(values.begin[0]), float(values.inverse[0]), first, change, largest)


class SlowDrift:
    """Evaluates cells, and remembers the last one for a stream that goes through it sample by sample."""

    def __init__(self, calibration: Calibration, stage: EffectStage) -> None:
        """Take the calibration, and its effects."""
        self._settings, self._box = calibration.features, calibration.calibrated_range
        self._models, self._stage = [channel.drift for channel in calibration.channels], stage
        self.forget()

    def forget(self) -> None:
        """Evaluate the next cell, whatever it is."""
        self._inputs: Inputs | None = None
        self._last: CellValues | None = None
        self._cell: Cell | None = None
        self._version = self._begin = self._until = 0

    def at(self, inputs: Inputs, stamps: Stamps, *, ordered: bool = False) -> tuple[CellValues, Places]:
        """Return the cells in which samples (n > 0,) at stamps in ns lie, and the place of each sample.

        ordered: whether the stamps are known to increase.
        """
        low, high = (stamps[0], stamps[-1]) if ordered or len(stamps) == 1 else (stamps.min(), stamps.max())
        if self._last is not None and self._begin <= low and high < self._until and self._is_current(inputs):
            return self._last, ALONE
        cells, places = cells_of(inputs, stamps)
        values = self.evaluate(inputs, cells)
        if places.index is None:
            self._remember(inputs, cells, values)
        return values, places

    def _remember(self, inputs: Inputs, cells: Cells, values: CellValues) -> None:
        """Have one cell (m = 1) at hand for the samples that follow."""
        self._begin, self._until = int(cells.begin[0]), int(cells.until[0])
        inputs.hold(self._begin, self._until)
        self._inputs, self._version, self._last, self._cell = inputs, inputs.version, values, None

    def ordinary(self, inputs: Inputs, first: int, last: int) -> list[tuple[Cell, int]] | None:
        """Return the cells from ``first`` to ``last`` (ns) and where each gives way to the next.

        None where there are many, or in one of them the temperature is not what the calibration knows.
        """
        found: list[tuple[Cell, int]] = []
        if last - first > MOST_CELLS * STEP:
            return None
        while not found or found[-1][1] <= last:
            cell = self._cell_at(inputs, found[-1][1] if found else first)
            if not cell.values.ordinary or len(found) == MOST_CELLS:
                return None
            found.append((cell, self._until))
        return found

    def _cell_at(self, inputs: Inputs, stamp: int) -> Cell:
        """Return the cell of a stamp (ns), which is now the last one."""
        if self._last is None or not self._begin <= stamp < self._until or not self._is_current(inputs):
            self.at(inputs, np.array([stamp], dtype=np.int64))
        if self._cell is None:
            assert self._last is not None
            self._cell = Cell.of(self._last)
        return self._cell

    def _is_current(self, inputs: Inputs) -> bool:
        """Return whether the last cell is what would be evaluated now."""
        return inputs is self._inputs and inputs.version == self._version

    def last_cell(self, inputs: Inputs) -> tuple[CellValues, int] | None:
        """Return the last cell that was evaluated alone, and the stamp (ns) at which it ends; None where it is old."""
        return (self._last, self._until) if self._last is not None and self._is_current(inputs) else None

    def evaluate(self, inputs: Inputs, cells: Cells) -> CellValues:
        """Return what holds in cells."""
        ends, known = np.concatenate([cells.begin, cells.end]), np.concatenate([cells.begin, cells.begin])
        features = read_features(inputs.temperature, self._settings, ends, known)
        inside = self._box.contains(features.values)
        status = temperature_status(features, self._settings, inside)
        # Without any temperature the drift at the middle of the range is the best guess there is; the
        # status says that it is one.
        missing = np.isinf(features.age)
        values = np.where(missing[:, None], self._box.middle, features.values)
        clamped = self._box.clamp(values)
        model = np.stack([drift.evaluate(clamped) for drift in self._models], axis=1)
        line, effects = Line.through(model), None
        if self._stage.has_slow:
            effects = self._effects(inputs, ends, known, clamped, missing)
        m = len(cells.begin)
        return CellValues(
            begin=cells.begin,
            inverse=1.0 / (cells.end - cells.begin),
            features=Line.through(values),
            model=line,
            effects=None if effects is None else Line.through(effects),
            drift=line if effects is None else Line.through(model + effects),
            status=status[:m],
            inside=inside[:m],
            mixed=(status[:m] != status[m:]) | (inside[:m] != inside[m:]),
            age=features.age[:m],
            since_power_on=features.since_power_on[:m],
            unusable=features.unusable[:m],
            missing=missing[:m],
        )

    def _effects(
        self, inputs: Inputs, ends: Stamps, known: Stamps, clamped: Array, missing: NDArray[np.bool_]
    ) -> Array:
        unread = np.broadcast_to(np.nan, (len(ends), len(CHANNELS)))
        at = inputs.conditions(ends, clamped, missing, unread, known)
        return self._stage.slow_drift(at, inputs.memory(ends, missing, known))
