"""Raw acceleration and slow inputs in, compensated acceleration out: sample by sample or in bulk."""

from collections import Counter
from collections.abc import Sequence
from copy import deepcopy
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.channels import CHANNELS
from hgma_compensation.effects.effect import Need, no_memory
from hgma_compensation.errors import RefusedError
from hgma_compensation.kalman.consistency import Consistency
from hgma_compensation.pipeline.cell_values import Cell, CellValues, values_of
from hgma_compensation.pipeline.cells import ALONE, Places
from hgma_compensation.pipeline.columns import Columns
from hgma_compensation.pipeline.compensated import Compensated, joined, zeros
from hgma_compensation.pipeline.filters import Filters
from hgma_compensation.pipeline.inputs import ACCELERATION_LAG, Inputs
from hgma_compensation.pipeline.ordinary_line import OrdinaryLine
from hgma_compensation.pipeline.screening import increases
from hgma_compensation.pipeline.slow_drift import SlowDrift
from hgma_compensation.pipeline.slow_samples import SlowSamples
from hgma_compensation.pipeline.stretches import Cut, Stretches
from hgma_compensation.pipeline.time_lines import TimeLines
from hgma_compensation.pipeline.uncertainty import DriftUncertainty
from hgma_compensation.stamps import Stamps, to_nanoseconds
from hgma_compensation.temperature.features import read_features
from hgma_compensation.temperature.track import Sample, TemperatureTrack

CHUNK = 65536
"""Samples evaluated at once: bounds the memory of the hidden layer."""


class Pipeline:
    """State of one sensor's compensation under one calibration.

    Samples of accelerometer, thermometers and supply voltage may be given in any interleaving; results are decided by
    stamps. columns: of CHANNELS. stage: the effects, with their state. Not thread-safe.
    """

    def __init__(self, calibration: Calibration, *, live: bool = False, lag: float | None = None) -> None:
        """Start without history.

        live: drop history that no sample can reach any more. lag: the same for a recording that is read in order, s by
        which its accelerometer may lag the slow inputs.
        """
        self.calibration = calibration
        self.stage = calibration.stage()
        lag = ACCELERATION_LAG if live else lag
        make = partial(Inputs, calibration.features, calibration.calibrated_range, self.stage, lag=lag)
        self._time_lines = TimeLines(make, live=live)
        self._filters = Filters(calibration)
        self._uncertainty = DriftUncertainty(calibration)
        self._slow = SlowDrift(calibration, self.stage)
        self._stretches = Stretches()
        self._before_gap: tuple[Filters, list[Any]] = (self._filters, self.stage.snapshot())
        self.cuts: Counter[Cut] = Counter()
        self.columns = Columns(calibration)

    @property
    def inputs(self) -> Inputs:
        """The slow inputs of the time line that the accelerometer is on."""
        return self._time_lines.current

    @property
    def track(self) -> TemperatureTrack:
        """The thermistor's history."""
        return self.inputs.temperature

    @property
    def gate_openings(self) -> int:
        """How often real acceleration has opened the gate of any channel's Kalman stage."""
        return self._filters.openings

    def take_consistency(self) -> list[Consistency]:
        """Return for each channel what the innovations of its Kalman stage were like since the last call."""
        return self._filters.take_consistency()

    def ordinary_line(self) -> OrdinaryLine | None:
        """Return the line on which samples lie that do nothing but go on from the newest one; None: look at each."""
        if self._filters.used or self.stage.has_fast or not self._time_lines.single:
            return None
        cell = None if self.newest is None else self._slow.last_cell(self.inputs, self.newest)
        return None if cell is None else OrdinaryLine.of(self.inputs, cell.values, cell.until, self.columns.calibrated)

    def go_on_to(self, line: OrdinaryLine, stamp: int) -> bool:
        """Move on to a stamp (ns) if a sample there is on the line and only goes on; return whether it does."""
        newest = self._stretches.newest
        if newest is None or not line.holds(stamp, newest, self.inputs) or not self._time_lines.single:
            return False
        self._stretches.newest = stamp
        return True

    def uniform_cells(self, first: int, last: int) -> list[Cell] | None:
        """Return the cells of samples from ``first`` to ``last`` (ns) that only go on.

        None where each sample must be looked at.
        """
        if self._filters.used or self.stage.has_fast or not self._time_lines.single:
            return None
        return self._slow.uniform(self.inputs, first, last) if self._stretches.only_go_on(first, last) else None

    def go_on_through(self, last: int) -> None:
        """Move on to the last (ns) of samples in ``uniform_cells``."""
        self._stretches.newest = last

    def ends_of_blocks(self, stamps: Stamps, cells: Sequence[Cell], left: NDArray[np.float64]) -> Compensated:
        """Return what there is to say of the last samples of blocks.

        stamps: (n,) ns. cells: those of the samples. left: (n, c), the samples without their drift.
        """
        if len(cells) == 1:
            said = self._said(stamps, cells[0].values, ALONE)
        else:
            said = self._said(stamps, values_of(cells), Places(np.arange(len(cells)), None))
        return Compensated(left, left, said)

    def _said(self, stamps: Stamps, cells: CellValues, places: Places) -> SlowSamples:
        calibration = self.calibration
        return SlowSamples(stamps, cells, places, calibration.features, calibration.calibrated_range, self._uncertainty)

    def only_go_on(self, stamps: Stamps) -> bool:
        """Return whether increasing stamps (n > 0,) in ns follow on those before without a gap."""
        return self._stretches.only_go_on(int(stamps[0]), int(stamps[-1]))

    def reset(self) -> None:
        """Forget all inputs, memories and filter states; the calibration stays."""
        self._time_lines.reset()
        self._stretches.reset()
        self.forget_acceleration()

    @property
    def newest(self) -> int | None:
        """Latest stamp of the accelerometer on its time line, ns."""
        return self._stretches.newest

    def succeed(self, before: "Pipeline") -> None:
        """Go on where another pipeline of the same sensor was with the acceleration, which this one has not seen.

        Memories that both have are taken over, moved to the level at which this one sees the sensor at rest. Kalman
        stages begin anew: what they learned is the drift that the other left.
        """
        self._stretches, newest = before._stretches, before.newest
        self._time_lines.succeed(before._time_lines)
        if newest is not None and self.stage.shares_memories(before.stage):
            at = np.array([newest], dtype=np.int64)
            self.stage.succeed(before.stage, before._at_rest(at) - self._at_rest(at))

    def _at_rest(self, stamps: Stamps) -> NDArray[np.float64]:
        """Return what the drift model takes the sensor at rest to show at one stamp (1,): (6,), 0 without a model."""
        box = self.calibration.calibrated_range
        features = read_features(self.track, self.calibration.features, stamps).values
        clamped = box.clamp(np.where(np.isnan(features), box.middle, features))
        level = np.zeros(len(CHANNELS))
        level[self.columns.calibrated] = [c.drift.evaluate(clamped)[0] + c.reference for c in self.calibration.channels]
        return level

    def forget_acceleration(self) -> None:
        """Let filters and memories of the acceleration begin anew; the slow inputs stay."""
        self.stage.reset()
        self._filters.reset()

    def add(self, need: Need | None, stamp: int, value: float) -> Sample:
        """Take a sample of an input, None for the thermistor (ns, °C or V), and say what became of it."""
        return self._time_lines.add(need, stamp, value, self._stretches.newest)

    def sets_back(self, need: Need | None, stamp: int) -> bool:
        """Return whether a sample of an input at a stamp (ns) would move those before it to a corrected clock."""
        return self._time_lines.sets_back(need, stamp)

    def comes_late(self, need: Need | None, stamp: int) -> bool:
        """Return whether an acceleration was compensated before that should have used a sample of an input, ns."""
        usable_from = stamp + to_nanoseconds(self.calibration.features.latency)
        return self.newest is not None and usable_from <= self.newest and not self._time_lines.is_ahead(need)

    def add_temperature(self, stamp: int, celsius: float) -> Sample:
        """Take a thermistor sample (ns, °C) and say what became of it."""
        return self.add(None, stamp, celsius)

    def add_temperature_2(self, stamp: int, celsius: float) -> Sample:
        """Take a sample of the second thermometer (ns, °C) and say what became of it."""
        return self.add(Need.TEMPERATURE_2, stamp, celsius)

    def add_supply_voltage(self, stamp: int, volts: float) -> Sample:
        """Take a sample of the supply voltage (ns, V) and say what became of it."""
        return self.add(Need.SUPPLY_VOLTAGE, stamp, volts)

    def compensate(
        self,
        stamps: Stamps,
        values: NDArray[np.float64],
        imu: NDArray[np.float64] | None = None,
        *,
        ordered: bool | None = None,
    ) -> Compensated:
        """Compensate finite samples, values (n, c) at stamps (n,) in ns.

        imu: (n, 6), columns CHANNELS, needed where an effect reads a channel that is not calibrated. ordered: whether
        the stamps increase, where the caller knows. Splitting the
        samples over several calls changes no bit of the result. Where the clock does more than go on, filters and
        memories of the acceleration begin anew or are carried: see Cut.
        """
        if imu is None and (missing := self.stage.other_channels):
            raise ValueError(f"effects of the calibration need imu: they read {', '.join(missing)}")
        if not len(stamps):
            return zeros(0, len(self.columns))
        ordered = increases(stamps) if ordered is None else ordered
        if ordered and len(stamps) <= CHUNK and self._stretches.go_on(stamps):
            self._time_lines.follow(int(stamps[0]))
            return self._compensate(stamps, values, imu, ordered)
        parts = []
        for rows, cut in self._stretches.split(stamps, CHUNK):
            self._enter(cut, int(stamps[rows.start]))
            part = None if imu is None else imu[rows]
            parts.append(self._compensate(stamps[rows], values[rows], part, ordered))
        return parts[0] if len(parts) == 1 else joined(parts)

    def _enter(self, cut: Cut, stamp: int) -> None:
        """Do what the cut before a stretch asks for; stamp: of its first sample, ns."""
        if cut is Cut.ANEW:
            self._time_lines.turn()
            self.forget_acceleration()
        elif cut in (Cut.GAP, Cut.PAUSE):
            self._before_gap = (deepcopy(self._filters), self.stage.snapshot())
        elif cut is Cut.RECALLED:
            self._filters = self._before_gap[0]
            self.stage.restore(self._before_gap[1])
        elif cut is Cut.SET_BACK:
            self._filters.set_back(stamp)
        self._time_lines.follow(stamp)
        if cut not in (Cut.NONE, Cut.GAP):
            self.cuts[cut] += 1

    def _compensate(
        self, stamps: Stamps, values: NDArray[np.float64], imu: NDArray[np.float64] | None, ordered: bool
    ) -> Compensated:
        """Compensate one stretch without a jump back in time."""
        slow = self._said(stamps, *self._slow.at(self.inputs, stamps, ordered=ordered))
        drift = self._with_fast_effects(stamps, values, imu, slow) if self.stage.has_fast else None
        unfiltered = slow.taken_from(values) if drift is None else values - drift
        if not self._filters.used:
            return Compensated(unfiltered, unfiltered, slow, drift)
        corrected, innovation = self._filters.run(stamps, unfiltered)
        return Compensated(corrected, unfiltered, slow, drift, innovation)

    def _with_fast_effects(
        self, stamps: Stamps, values: NDArray[np.float64], imu: NDArray[np.float64] | None, slow: SlowSamples
    ) -> NDArray[np.float64]:
        """Return the drift (n, c) of the slow inputs, and of the effects that each sample must be looked at for."""
        acceleration = self.columns.widened(values) if imu is None else imu.copy(order="K")
        acceleration[:, self.columns.calibrated] = values - slow.model
        at = self.inputs.conditions(stamps, slow.clamped, slow.unknown, acceleration)
        memory = self.inputs.memory(stamps, slow.unknown) if self.stage.fast_need_memory else no_memory(len(stamps))
        effects = slow.effects
        self.stage.add_fast(effects, at, memory)
        return slow.model + effects

    def snapshot(self) -> dict[str, Any]:
        """Return, as plain JSON, all that later drift depends on; the Kalman stages begin anew after it."""
        return {
            "calibration_id": self.calibration.calibration_id,
            "inputs": self.inputs.snapshot(self.newest),
            "stretches": self._stretches.snapshot(),
            "effects": self.stage.snapshot(),
        }

    def restore(self, snapshot: dict[str, Any]) -> None:
        """Go on from a snapshot; raises RefusedError, beginning without history, where it does not fit."""
        self.reset()
        if snapshot.get("calibration_id") != self.calibration.calibration_id:
            raise RefusedError(
                f"the snapshot belongs to calibration {str(snapshot.get('calibration_id'))[:40]}, "
                f"not to {self.calibration.calibration_id}: start without it"
            )
        try:
            self.inputs.restore(snapshot["inputs"])
            self.stage.restore(snapshot["effects"])
            self._stretches.restore(snapshot["stretches"])
        except (KeyError, TypeError, ValueError, OverflowError) as error:
            self.reset()
            raise RefusedError(f"the snapshot is damaged ({error}): start without it") from None
