"""A pipeline that lives in a node: swaps calibrations, remembers the slow inputs, counts what it skips."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import isfinite

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.channels import columns_of
from hgma_compensation.effects.effect import Need
from hgma_compensation.errors import RefusedError
from hgma_compensation.pipeline.compensated import Compensated
from hgma_compensation.pipeline.live_state import ACCELERATION, INPUTS, LiveState
from hgma_compensation.pipeline.pipeline import Pipeline
from hgma_compensation.pipeline.reasons import LATE, MISSING, Note, Skip, sample_name
from hgma_compensation.pipeline.remembered import Remembered
from hgma_compensation.pipeline.settling import MemorySpan, Unsettled, unsettled
from hgma_compensation.pipeline.taking_up import Offer, Past
from hgma_compensation.stamps import Stamps, to_nanoseconds
from hgma_compensation.temperature.track import Sample

SLOW_INPUTS = (None, Need.TEMPERATURE_2, Need.SUPPLY_VOLTAGE)
"""None is the thermistor."""


@dataclass(frozen=True)
class LiveResult:
    """What became of the samples, and under which calibration; every sample of it belongs to that one."""

    calibration: Calibration
    compensated: Compensated


class LiveCompensation:
    """The node's state without ROS. Not thread-safe: one executor thread owns it."""

    def __init__(self) -> None:
        """Start without a calibration."""
        self.counts: Counter[str] = Counter()
        self.received = self.compensated = 0
        self.last_result: LiveResult | None = None
        self._pipeline: Pipeline | None = None
        self._remembered: dict[Need | None, Remembered] = {need: Remembered() for need in SLOW_INPUTS}
        self._last_acceleration: int | None = None
        self._span = MemorySpan()
        self._offer: Offer | None = None
        self.past = Past.NONE

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
        pipeline = Pipeline(calibration, live=True)
        if (power_on := self._remembered[None].power_on) is not None:
            pipeline.track.updates.assume_power_on(power_on)
        for need in pipeline.inputs.wanted:
            for stamp, value in self._remembered[need]:
                pipeline.inputs.add(need, stamp, value)
        self._pipeline = pipeline

    def remove_calibration(self) -> None:
        """Drop the calibration; samples are skipped until another is installed."""
        self._pipeline = None
        self.last_result = None

    def reset(self) -> None:
        """Forget the history of all inputs, memories and filter states; calibration and counts stay."""
        for samples in self._remembered.values():
            samples.clear()
        self._last_acceleration, self._span = None, MemorySpan()
        self._offer, self.past = None, Past.CLEARED
        if self._pipeline is not None:
            self._pipeline.reset()

    @property
    def unsettled(self) -> list[Unsettled]:
        """Effects of the calibration in use that still show that their memory began without a past."""
        return unsettled(self.calibration, self._span) if self.calibration else []

    @property
    def position(self) -> tuple[int | None, ...] | None:
        """Newest stamps of all inputs, ns, which tell whether a snapshot would be another; None before there is one.

        While a state waits for the first sample there is none: it must not be replaced by less.
        """
        if self._offer is not None:
            return None
        stamps = (self._last_acceleration, *(self._remembered[need].newest for need in SLOW_INPUTS))
        return None if stamps == (None,) * len(stamps) else stamps

    def snapshot(self) -> LiveState:
        """Return all that later drift depends on; the Kalman stages begin anew after it."""
        return LiveState(
            self.calibration.calibration_id if self.calibration else "",
            self.calibration.sensor_id if self.calibration else "",
            self._pipeline.snapshot() if self._pipeline else None,
            {need: samples.copy() for need, samples in self._remembered.items()},
            replace(self._span),
            self._last_acceleration,
        )

    def offer(self, state: LiveState, max_age: float) -> None:
        """Take a state up when the first sample comes, if that is at most ``max_age`` s younger; else drop it."""
        self._offer, self.past = Offer(state, to_nanoseconds(max_age)), Past.WAITING

    def _begin(self, source: str, stamp: int) -> None:
        """Decide, at the first sample, whether the state that is offered is taken up."""
        assert self._offer is not None
        offer, self._offer = self._offer, None
        self.past = offer.judge(source, stamp, self.calibration.sensor_id if self.calibration else "")
        if self.past is Past.TAKEN_UP:
            self.restore(offer.state)
        else:
            self.counts[self.past.value] += 1

    def restore(self, state: LiveState) -> None:
        """Go on from a state; memories of another calibration's are built anew from the samples in it."""
        self._remembered.update({need: samples.copy() for need, samples in state.remembered.items()})
        self._span, self._last_acceleration = replace(state.span), state.acceleration
        self.past = Past.REPLAYED
        if self._pipeline is None:
            return
        try:
            self._pipeline.restore(state.pipeline or {})
            self.past = Past.TAKEN_UP
        except RefusedError:
            self.install(self._pipeline.calibration)

    def add_temperature(self, stamp: int, celsius: float) -> None:
        """Take a thermistor sample (ns, °C)."""
        self._add(None, stamp, celsius)

    def add_temperature_2(self, stamp: int, celsius: float) -> None:
        """Take a sample of the second thermometer (ns, °C)."""
        self._add(Need.TEMPERATURE_2, stamp, celsius)

    def add_supply_voltage(self, stamp: int, volts: float) -> None:
        """Take a sample of the supply voltage (ns, V)."""
        self._add(Need.SUPPLY_VOLTAGE, stamp, volts)

    def _add(self, need: Need | None, stamp: int, value: float) -> None:
        if self._offer is not None and isfinite(value):
            self._begin(INPUTS[need], stamp)
        if need is None:
            self._span.add(stamp, value)
        remembered = self._remembered[need]
        remembered.add(stamp, value)
        if self._pipeline is None or need not in self._pipeline.inputs.wanted:
            return
        sample = self._pipeline.inputs.add(need, stamp, value)
        if sample is Sample.RESTARTED:
            remembered.clear()
            remembered.add(stamp, value)
        if sample is not Sample.USED:
            self.counts[sample_name(need, sample)] += 1
        elif self._is_late(stamp):
            self.counts[LATE[need].value] += 1

    def _is_late(self, stamp: int) -> bool:
        """Return whether an acceleration was compensated before that should have used this sample."""
        assert self._pipeline is not None
        usable_from = stamp + to_nanoseconds(self._pipeline.calibration.features.latency)
        return self._last_acceleration is not None and usable_from <= self._last_acceleration

    def compensate(self, stamps: Stamps, values: NDArray[np.float64]) -> LiveResult | None:
        """Return the compensated samples, or None and a counted reason.

        stamps: (n,) ns. values: (n, 6), columns CHANNELS. A block with a number that is not finite in a channel that
        is calibrated, or that an effect reads, is skipped whole, so that none enters a filter.
        """
        self.received += len(stamps)
        if self._pipeline is None:
            self._skip(Skip.NO_CALIBRATION, len(stamps))
            return None
        calibration = self._pipeline.calibration
        wanted = values[:, columns_of(calibration.names)]
        if not np.isfinite(values[:, self._pipeline.columns_read]).all():
            self._skip(Skip.NOT_FINITE, len(stamps))
            return None
        if self._offer is not None and len(stamps):
            self._begin(ACCELERATION, int(stamps[0]))
        jumps = self._pipeline.jumps_back
        self.last_result = LiveResult(calibration, self._pipeline.compensate(stamps, wanted, values))
        if self._pipeline.jumps_back > jumps:
            self.counts[Note.TIME_JUMPED_BACK.value] += self._pipeline.jumps_back - jumps
        for need in self.missing_inputs:
            self.counts[MISSING[need].value] += len(stamps)
        self._last_acceleration = int(stamps[-1])
        self.compensated += len(stamps)
        return self.last_result

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
