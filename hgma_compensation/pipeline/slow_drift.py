"""The drift that the slow inputs make, evaluated at both ends of cells: drift model and slow effects.

Between the ends it is a straight line. Nothing steps inside a cell, so that with h = STEP the line is off by at most
h²/8 times the greatest second derivative of the drift with time in it (the chord's bound; de Boor 2001, section III):
see docs/METHOD.md for its size.
"""

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.channels import CHANNELS
from hgma_compensation.effects.stage import EffectStage
from hgma_compensation.pipeline.cell_values import Cell, CellValues, KnownCells, Line
from hgma_compensation.pipeline.cells import ALONE, STEP, Cells, Places, cells_from, cells_of
from hgma_compensation.pipeline.inputs import Inputs
from hgma_compensation.pipeline.status import temperature_status
from hgma_compensation.stamps import Stamps
from hgma_compensation.temperature.features import read_features

Array = NDArray[np.float64]

MOST_CELLS = 4
"""Beyond that many, cells are evaluated together."""


class SlowDrift:
    """Evaluates cells; some of them ahead, for a stream that goes through them."""

    def __init__(self, calibration: Calibration, stage: EffectStage) -> None:
        """Take the calibration, and its effects."""
        self._settings, self._box = calibration.features, calibration.calibrated_range
        self._models, self._stage = [channel.drift for channel in calibration.channels], stage
        self._inputs: Inputs | None = None
        self._version = 0
        self._ahead = KnownCells()

    def at(self, inputs: Inputs, stamps: Stamps, *, ordered: bool = False) -> tuple[CellValues, Places]:
        """Return the cells in which samples (n > 0,) at stamps in ns lie, and the place of each sample.

        ordered: whether the stamps are known to increase.
        """
        low, high = (stamps[0], stamps[-1]) if ordered or len(stamps) == 1 else (stamps.min(), stamps.max())
        cell = self._cell_of(inputs, int(low)) if int(low) // STEP == int(high) // STEP else None
        if cell is not None and high < cell.until:
            return cell.values, ALONE
        cells, places = cells_of(inputs, stamps)
        return self.evaluate(inputs, cells), places

    def uniform(self, inputs: Inputs, first: int, last: int) -> list[Cell] | None:
        """Return the cells from ``first`` to ``last`` (ns).

        None where there are many, or one in which not all that is said of the temperature is the same for all samples.
        """
        found: list[Cell] = []
        stamp = first
        while stamp <= last:
            cell = self._cell_of(inputs, stamp)
            if not cell.uniform or len(found) == MOST_CELLS:
                return None
            found.append(cell)
            stamp = cell.until
        return found

    def last_cell(self, inputs: Inputs, stamp: int) -> Cell | None:
        """Return the cell of a stamp (ns), None where it is not known."""
        return self._ahead.at(stamp) if self._is_current(inputs) else None

    def _cell_of(self, inputs: Inputs, stamp: int) -> Cell:
        """Return the cell of a stamp, ns."""
        cell = self._ahead.at(stamp) if self._is_current(inputs) else None
        if cell is None:
            cells = cells_from(inputs, stamp, inputs.settled)
            self._ahead = KnownCells.of(cells, self.evaluate(inputs, cells))
            inputs.hold(int(cells.begin[0]), int(cells.until[-1]))
            self._inputs, self._version = inputs, inputs.version
            cell = self._ahead.at(stamp)
        assert cell is not None
        return cell

    def _is_current(self, inputs: Inputs) -> bool:
        """Return whether the cells at hand are what would be evaluated now."""
        return inputs is self._inputs and inputs.version == self._version

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
