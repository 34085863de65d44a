"""What a node remembers beside its pipeline: samples of the slow inputs, and a past from before its start."""

from dataclasses import replace
from math import isfinite

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.effects.effect import Need
from hgma_compensation.pipeline.live_state import LiveState
from hgma_compensation.pipeline.pipeline import Pipeline
from hgma_compensation.pipeline.prepared import Histories
from hgma_compensation.pipeline.remembered import Remembered
from hgma_compensation.pipeline.settling import MemorySpan, Unsettled, unsettled
from hgma_compensation.pipeline.taking_up import Offer, Past
from hgma_compensation.stamps import to_nanoseconds
from hgma_compensation.temperature.track import Sample

SLOW_INPUTS = (None, Need.TEMPERATURE_2, Need.SUPPLY_VOLTAGE)
"""None is the thermistor."""


class LiveMemory:
    """samples: of each slow input. past: what became of the state from before the start."""

    def __init__(self) -> None:
        """Start without a past."""
        self.samples: dict[Need | None, Remembered] = {need: Remembered() for need in SLOW_INPUTS}
        self.past = Past.NONE
        self._span = MemorySpan()
        self._offer: Offer | None = None

    def clear(self) -> None:
        """Forget everything, also a state that waits."""
        for samples in self.samples.values():
            samples.clear()
        self._span = MemorySpan()
        self._offer, self.past = None, Past.CLEARED

    def histories(self) -> Histories:
        """Return a copy of the samples."""
        return {need: samples.history() for need, samples in self.samples.items()}

    def note(self, need: Need | None, stamp: int, value: float, outcome: Sample) -> None:
        """Take what a pipeline said of a sample that was remembered: where time begins anew, so does the memory."""
        if need is None:
            self._span.add(stamp, value, outcome)
        if outcome is Sample.RESTARTED:
            self.samples[need].clear()
            self.samples[need].add(stamp, value)

    def unsettled(self, calibration: Calibration) -> list[Unsettled]:
        """Return the effects of a calibration that still show that their memory began without a past."""
        return unsettled(calibration, self._span)

    def position(self, acceleration: int | None) -> tuple[int | None, ...] | None:
        """Return the newest stamps of all inputs, ns; None before there is one, and while a state waits."""
        stamps = (acceleration, *(self.samples[need].newest for need in SLOW_INPUTS))
        return None if self._offer is not None or stamps == (None,) * len(stamps) else stamps

    def snapshot(self, pipeline: Pipeline | None) -> LiveState:
        """Return it all, with the state of the pipeline in use."""
        calibration = pipeline.calibration if pipeline else None
        return LiveState(
            calibration.calibration_id if calibration else "",
            calibration.sensor_id if calibration else "",
            pipeline.snapshot() if pipeline else None,
            {need: samples.copy() for need, samples in self.samples.items()},
            replace(self._span),
            pipeline.newest if pipeline else None,
        )

    def offer(self, state: LiveState, max_age: float) -> None:
        """Take a state up when the first sample comes, if that is at most ``max_age`` s younger; else drop it."""
        self._offer, self.past = Offer(state, to_nanoseconds(max_age)), Past.WAITING

    def decide(self, source: str, stamp: int, value: float, sensor_id: str) -> LiveState | None:
        """Return the state that waits if the first sample (ns, value) is here and shows it to be young enough.

        source: name of the input that the sample is of. sensor_id: of the calibration in use, "" without one. A sample
        that is broken decides nothing.
        """
        if self._offer is None or stamp <= 0 or not isfinite(value):
            return None
        offer, self._offer = self._offer, None
        self.past = offer.judge(source, stamp, sensor_id)
        return offer.state if self.past is Past.TAKEN_UP else None

    def take(self, state: LiveState) -> None:
        """Go on from a state that was decided for."""
        for need, samples in state.remembered.items():
            self.samples[need].begin_with(samples)
        self._span = replace(state.span)
