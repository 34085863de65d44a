"""A pipeline that lives in a node: swaps calibrations, remembers the slow inputs, counts what it skips."""

from collections import Counter
from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.channels import group_of
from hgma_compensation.effects.effect import Need
from hgma_compensation.errors import RefusedError
from hgma_compensation.pipeline.compensated import Compensated, joined
from hgma_compensation.pipeline.live_memory import LiveMemory
from hgma_compensation.pipeline.live_state import ACCELERATION, INPUTS, LiveState
from hgma_compensation.pipeline.observer import Observer
from hgma_compensation.pipeline.ordinary_line import OrdinaryLine
from hgma_compensation.pipeline.pipeline import Pipeline
from hgma_compensation.pipeline.prepared import Histories, Prepared, prepare
from hgma_compensation.pipeline.reasons import LATE, Note, Skip, sample_name
from hgma_compensation.pipeline.screening import increases, out_of_step, reason_to_skip, usable_samples
from hgma_compensation.pipeline.settling import Unsettled
from hgma_compensation.pipeline.status import TemperatureStatus
from hgma_compensation.pipeline.taking_up import DROPPED, Past
from hgma_compensation.stamps import Stamps
from hgma_compensation.temperature.track import Sample

FIRST_ROW = np.zeros(1, dtype=np.int64)
"""The row of a sample that comes alone."""


@dataclass(frozen=True)
class LiveResult:
    """What became of the samples, and under which calibration; every sample of it belongs to that one."""

    calibration: Calibration
    compensated: Compensated


class LiveCompensation:
    """The node's state without ROS. Not thread-safe: one executor thread owns it.

    stop_on: statuses of the temperature in which samples get no output. temperatures: thermistor samples so far.
    observer: of the pipeline in use.
    """

    def __init__(self) -> None:
        """Start without a calibration."""
        self.counts: Counter[str] = Counter()
        self.received = self.compensated = self.temperatures = 0
        self.last_result: LiveResult | None = None
        self.stop_on: frozenset[TemperatureStatus] = frozenset()
        self.observer: Observer | None = None
        self._pipeline: Pipeline | None = None
        self._frame: str | None = None
        self._memory = LiveMemory()
        self._line: OrdinaryLine | None = None

    @property
    def calibration(self) -> Calibration | None:
        """The calibration in use."""
        return self._pipeline.calibration if self._pipeline else None

    @property
    def gate_openings(self) -> int:
        """Gate openings of the Kalman stage under the calibration in use."""
        return self._pipeline.gate_openings if self._pipeline else 0

    @property
    def missing_inputs(self) -> tuple[Need, ...]:
        """Inputs that an effect of the calibration in use needs, and that have never come."""
        return self._pipeline.inputs.missing if self._pipeline else ()

    def install(self, calibration: Calibration) -> None:
        """Use a calibration from the next sample on; it starts from what is remembered of the slow inputs."""
        self.adopt(prepare(calibration, self.histories()))

    def histories(self) -> Histories:
        """Return a copy of what is remembered of the slow inputs, for ``prepare`` elsewhere."""
        return self._memory.histories()

    def adopt(self, prepared: Prepared) -> None:
        """Use what was prepared from the next sample on, as if it had been installed when its histories were taken.

        Memories of the acceleration that it shares with the calibration before it go on. Where the history began anew
        in the meantime, it is prepared again.
        """
        if not prepared.follows(self._memory.samples):
            prepared = prepare(prepared.pipeline.calibration, self.histories())
        prepared.catch_up(self._memory.samples)
        if self._pipeline is not None:
            prepared.pipeline.succeed(self._pipeline)
        self._pipeline, self._line = prepared.pipeline, None
        self.observer = Observer(prepared.pipeline, self.counts)

    def remove_calibration(self) -> None:
        """Drop the calibration; samples are skipped until another is installed."""
        self._pipeline = self.observer = self._line = None
        self.last_result = None

    def reset(self) -> None:
        """Forget the history of all inputs, memories and filter states; calibration and counts stay."""
        self._memory.clear()
        self._line = None
        if self._pipeline is not None and self.observer is not None:
            self._pipeline.reset()
            self.observer.reset()

    @property
    def past(self) -> Past:
        """What became of the state from before the start."""
        return self._memory.past

    @property
    def unsettled(self) -> list[Unsettled]:
        """Effects of the calibration in use that still show that their memory began without a past."""
        return self._memory.unsettled(self.calibration) if self.calibration else []

    @property
    def position(self) -> tuple[int | None, ...] | None:
        """Newest stamps of all inputs, ns, which tell whether a snapshot would be another; None before there is one.

        While a state waits for the first sample there is none: it must not be replaced by less.
        """
        return self._memory.position(self._pipeline.newest if self._pipeline else None)

    def snapshot(self) -> LiveState:
        """Return all that later drift depends on; the Kalman stages begin anew after it."""
        return self._memory.snapshot(self._pipeline)

    def offer(self, state: LiveState, max_age: float) -> None:
        """Take a state up when the first sample comes, if that is at most ``max_age`` s younger; else drop it."""
        self._memory.offer(state, max_age)

    def _begin(self, source: str, stamp: int, value: float) -> None:
        """Decide, at the first sample, whether the state that is offered is taken up."""
        if self.past is not Past.WAITING:
            return
        state = self._memory.decide(source, stamp, value, self.calibration.sensor_id if self.calibration else "")
        if state is not None:
            self._restore(state)
        elif self.past in DROPPED:
            self.counts[self.past.value] += 1

    def _restore(self, state: LiveState) -> None:
        """Go on from a state; memories of another calibration's are built anew from the samples in it."""
        self._memory.take(state)
        self._line = None
        if self._pipeline is None:
            self._memory.past = Past.REPLAYED
            return
        try:
            self._pipeline.restore(state.pipeline or {})
        except RefusedError:
            self._memory.past = Past.REPLAYED
            self.install(self._pipeline.calibration)

    def add_temperature(self, stamp: int, celsius: float) -> None:
        """Take a thermistor sample (ns, °C)."""
        self.temperatures += 1
        self._add(None, stamp, celsius)

    def add_temperature_2(self, stamp: int, celsius: float) -> None:
        """Take a sample of the second thermometer (ns, °C)."""
        self._add(Need.TEMPERATURE_2, stamp, celsius)

    def add_supply_voltage(self, stamp: int, volts: float) -> None:
        """Take a sample of the supply voltage (ns, V)."""
        self._add(Need.SUPPLY_VOLTAGE, stamp, volts)

    def _add(self, need: Need | None, stamp: int, value: float) -> None:
        self._begin(INPUTS[need], stamp, value)
        self._memory.samples[need].add(stamp, value)
        if self._pipeline is None or need not in self._pipeline.inputs.wanted:
            return
        sample = self._pipeline.add(need, stamp, value)
        self._memory.note(need, stamp, value, sample)
        if sample is not Sample.USED:
            self.counts[sample_name(need, sample)] += 1
        elif self._pipeline.comes_late(need, stamp):
            self.counts[LATE[need].value] += 1

    def compensate(self, stamps: Stamps, values: NDArray[np.float64]) -> LiveResult | None:
        """Return the compensated samples, or None and a counted reason.

        stamps: (n,) ns. values: (n, 6), columns CHANNELS. A block with a sample that is not usable in a channel that
        is calibrated, or that an effect reads, is skipped whole, so that none enters a filter.
        """
        self.received += len(stamps)
        if self._pipeline is None:
            self._skip(Skip.NO_CALIBRATION, len(stamps))
            return None
        reason = reason_to_skip(stamps, values[:, self._pipeline.columns_read])
        if reason is not None:
            self._skip(reason, len(stamps))
            return None
        self.last_result = self._run(stamps, values)
        if self.stop_on and any(status in self.stop_on for status in self.last_result.compensated.status.tolist()):
            self._skip(Skip.STOPPED, len(stamps))
            return None
        self.compensated += len(stamps)
        return self.last_result

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
        rows = self._usable_rows(stamps, values[:, self._pipeline.columns_read])
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

    def _draw_line(self, pipeline: Pipeline, observer: Observer) -> None:
        """Draw the line for the samples that follow, if nothing will have to be said of them."""
        line = pipeline.ordinary_line()
        self._line = line if line is not None and observer.silent_until(line.until) else None

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
        result = pipeline.compensate(stamps, pipeline.columns_of(values), values, ordered=ordered)
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
