"""Samples of the accelerometer on their way through the node's pipeline: alone, together, and in blocks."""

from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Collection, Sequence

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.channels import group_of
from hgma_compensation.pipeline.compensated import Compensated, joined
from hgma_compensation.pipeline.live_result import BlockEnd, LiveResult
from hgma_compensation.pipeline.live_state import ACCELERATION
from hgma_compensation.pipeline.observer import Observer
from hgma_compensation.pipeline.ordinary_block import BlockOffsets, OrdinaryBlocks, Rows
from hgma_compensation.pipeline.ordinary_line import OrdinaryLine
from hgma_compensation.pipeline.pipeline import Pipeline
from hgma_compensation.pipeline.reasons import Note, Skip
from hgma_compensation.pipeline.screening import increases, out_of_step, reason_to_skip, usable_samples
from hgma_compensation.pipeline.status import TemperatureStatus
from hgma_compensation.stamps import Stamps

FIRST_ROW = np.zeros(1, dtype=np.int64)
"""The row of a sample that comes alone."""


class LiveSamples(ABC):
    """Compensates, counts and skips samples under the pipeline in use.

    stop_on: statuses of the temperature in which samples get no output. observer: of the pipeline in use. block_end: of
    the last samples that were looked at, if they were a block that was taken as a whole.
    """

    def __init__(self) -> None:
        """Start without a calibration."""
        self.counts: Counter[str] = Counter()
        self.received = self.compensated = 0
        self._last: LiveResult | None = None
        self.block_end: BlockEnd | None = None
        self._blocks = OrdinaryBlocks()
        self.stop_on: frozenset[TemperatureStatus] = frozenset()
        self.observer: Observer | None = None
        self._pipeline: Pipeline | None = None
        self._frame: str | None = None
        self._line: OrdinaryLine | None = None

    @property
    def calibration(self) -> Calibration | None:
        """The calibration in use."""
        return self._pipeline.calibration if self._pipeline else None

    @property
    def last_result(self) -> LiveResult | None:
        """What became of the last samples that were looked at; of a block of which nothing is to be said, its end."""
        return self.block_end.result if self.block_end is not None else self._last

    @last_result.setter
    def last_result(self, result: LiveResult | None) -> None:
        self._last, self.block_end = result, None

    @abstractmethod
    def _begin(self, source: str, stamp: int, value: float) -> None:
        """Do what is to be done before the first sample of all, at a stamp in ns."""

    def compensate(self, stamps: Stamps, values: NDArray[np.float64]) -> LiveResult | None:
        """Return the compensated samples, or None and a counted reason.

        stamps: (n,) ns. values: (n, 6), columns CHANNELS. A block with a sample that is not usable in a channel that
        is calibrated, or that an effect reads, is skipped whole, so that none enters a filter.
        """
        self.received += len(stamps)
        if self._pipeline is None:
            self._skip(Skip.NO_CALIBRATION, len(stamps))
            return None
        reason = reason_to_skip(stamps, values[:, self._pipeline.columns.read])
        if reason is not None:
            self._skip(reason, len(stamps))
            return None
        self.last_result = result = self._run(stamps, values)
        if self.stop_on and self._stops(result.compensated):
            self._skip(Skip.STOPPED, len(stamps))
            return None
        self.compensated += len(stamps)
        return result

    def compensate_each(
        self, stamps: Stamps, values: NDArray[np.float64]
    ) -> tuple[LiveResult, NDArray[np.int64]] | None:
        """Return the compensated samples of those that are usable, and their rows (k,); None where there is none.

        As ``compensate`` for one sample after the other, for samples that came each in a message of its own.
        """
        if len(stamps) == 1:
            alone = self.compensate(stamps, values)
            return None if alone is None else (alone, FIRST_ROW)
        self.received += len(stamps)
        if self._pipeline is None:
            self._skip(Skip.NO_CALIBRATION, len(stamps))
            return None
        rows = self._usable_rows(stamps, values[:, self._pipeline.columns.read])
        if not len(rows):
            return None
        if len(rows) < len(stamps):
            stamps, values = stamps[rows], values[rows]
        result = self._run_each(stamps, values)
        self.last_result = LiveResult(self._pipeline.calibration, result)
        if self.stop_on and not result.ordinary:
            goes = ~np.isin(result.status, [int(status) for status in self.stop_on])
            self._skip(Skip.STOPPED, len(rows) - int(np.count_nonzero(goes)))
            if not goes.any():
                return None
            result, rows = result.take(np.flatnonzero(goes)), rows[goes]
        self.compensated += len(rows)
        return LiveResult(self._pipeline.calibration, result), rows

    def compensate_ordinary(self, stamp: int, values: tuple[float, ...]) -> list[float] | None:
        """Return the channels (c,) of a sample of which nothing is to be said; None: give it to ``compensate``.

        stamp: ns. values: (6,) in the order of CHANNELS. Every bit, count and later result is as after ``compensate``;
        only ``last_result`` stays that of the last sample that was looked at, in the same cell.
        """
        line, pipeline, observer = self._line, self._pipeline, self.observer
        if line is None or pipeline is None or observer is None or not observer.goes_on(stamp):
            return None
        found = line.compensated(stamp, values)
        if found is None or not pipeline.go_on_to(line, stamp):
            return None
        observer.observe_one(found)
        self.received += 1
        self.compensated += 1
        return found

    def compensate_block(self, stamp: int, offsets: BlockOffsets, axes: Rows, out: Rows) -> bool:
        """Write a block (3, n) of the acceleration, compensated, to ``out`` (3, n) if it can be taken as a whole.

        stamp: of the block, ns. Return False where not, or where it gets no output: give it to ``compensate``, after
        which every bit, count and later result is the same as after this. Axes that are not calibrated are not written.
        """
        pipeline, observer = self._pipeline, self.observer
        calibrated = None if pipeline is None else pipeline.columns.axes
        if pipeline is None or observer is None or calibrated is None or not offsets.plain:
            return False
        last = stamp + offsets.last
        cells = pipeline.uniform_cells(stamp, last)
        if cells is None or any(cell.status in self.stop_on for cell in cells):
            return False
        if not observer.has_nothing_to_say(stamp, last):
            return False
        sums = self._blocks.take(stamp, offsets, axes[calibrated], cells, out[calibrated])
        if sums is None:
            return False
        pipeline.go_on_through(last)
        self.block_end = BlockEnd(pipeline, last, cells[-1], sums.last)
        observer.observe_block(stamp, last, sums, self.block_end)
        self.received += sums.count
        self.compensated += sums.count
        return True

    def _draw_line(self, pipeline: Pipeline, observer: Observer) -> None:
        """Draw the line for the samples that follow, if nothing will have to be said of them."""
        line = pipeline.ordinary_line()
        self._line = line if line is not None and observer.silent_until(line.until) else None

    def _stops(self, result: Compensated) -> bool:
        """Return whether the temperature of any sample is in a status in which there is no output."""
        return not result.ordinary and any(bool((result.status == int(status)).any()) for status in self.stop_on)

    def _usable_rows(self, stamps: Stamps, read: NDArray[np.float64]) -> NDArray[np.int64]:
        """Return the rows (k,) of samples that are usable, read (n, r) being what is read of them; count the others."""
        usable = usable_samples(stamps, read)
        if usable.all():
            return np.arange(len(stamps))
        for row in np.flatnonzero(~usable):
            reason = reason_to_skip(stamps[row : row + 1], read[row : row + 1])
            assert reason is not None
            self._skip(reason, 1)
        return np.flatnonzero(usable)

    def _run_each(self, stamps: Stamps, values: NDArray[np.float64]) -> Compensated:
        """Return the result for samples (n > 0,) that are usable, each as if it had come alone."""
        assert self._pipeline is not None
        if increases(stamps) and self._pipeline.only_go_on(stamps):
            return self._run(stamps, values).compensated
        # What is said of a sample whose clock did more than go on depends on where the one before has led.
        each = [self._run(stamps[row : row + 1], values[row : row + 1]) for row in range(len(stamps))]
        return joined([one.compensated for one in each])

    def _run(self, stamps: Stamps, values: NDArray[np.float64]) -> LiveResult:
        """Compensate usable samples (n,), values (n, 6)."""
        if len(stamps):
            self._begin(ACCELERATION, int(stamps[0]), 0.0)
        pipeline, observer = self._pipeline, self.observer
        assert pipeline is not None
        assert observer is not None
        ordered = increases(stamps)
        for note, count in out_of_step(stamps, pipeline.newest, ordered=ordered).items():
            self.counts[note.value] += count
        result = pipeline.compensate(stamps, pipeline.columns.of(values), values, ordered=ordered)
        observer.observe(stamps, result)
        if len(stamps) == 1:
            self._draw_line(pipeline, observer)
        return LiveResult(pipeline.calibration, result)

    def covers(self, groups: Collection[str]) -> bool:
        """Return whether the calibration in use compensates a channel of one of these fields of an Imu."""
        return (
            bool(groups) and self.calibration is not None and any(group_of(n) in groups for n in self.calibration.names)
        )

    def begin_frame(self, frame: str) -> None:
        """Take note of the frame of the next samples; where it changes, another sensor may have come."""
        if self._frame is not None and frame != self._frame and self._pipeline is not None:
            self.counts[Note.FRAME_CHANGED.value] += 1
            self._pipeline.forget_acceleration()
        self._frame = frame

    def note(self, note: Note) -> None:
        """Count what was seen of a sample outside of here."""
        self.counts[note.value] += 1

    def skip_unseen(self, reason: Skip, samples: int) -> None:
        """Count samples that came and were not even given to ``compensate``."""
        self.received += samples
        self._skip(reason, samples)

    def _skip(self, reason: Skip, samples: int) -> None:
        self.counts[reason.value] += samples

    def skipped(self) -> int:
        """Return how many samples got no output, whatever the reason."""
        return sum(self.counts[reason.value] for reason in Skip)


def single_sample(stamp: int, values: Sequence[float]) -> tuple[Stamps, NDArray[np.float64]]:
    """Return one sample in the shapes that ``compensate`` takes."""
    return np.array([stamp], dtype=np.int64), np.array([values], dtype=np.float64)
