"""A pipeline that lives in a node: swaps calibrations, remembers the slow inputs, counts what it skips."""

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.effects.effect import Need
from hgma_compensation.errors import RefusedError
from hgma_compensation.pipeline.live_memory import LiveMemory
from hgma_compensation.pipeline.live_samples import LiveSamples
from hgma_compensation.pipeline.live_state import INPUTS, LiveState
from hgma_compensation.pipeline.observer import Observer
from hgma_compensation.pipeline.prepared import Histories, Prepared, prepare
from hgma_compensation.pipeline.reasons import LATE, sample_name
from hgma_compensation.pipeline.settling import Unsettled
from hgma_compensation.pipeline.taking_up import DROPPED, Past
from hgma_compensation.temperature.track import Sample


class LiveCompensation(LiveSamples):
    """The node's state without ROS. Not thread-safe: one executor thread owns it.

    temperatures: thermistor samples so far; the rest as in LiveSamples.
    """

    def __init__(self) -> None:
        """Start without a calibration."""
        super().__init__()
        self.temperatures = 0
        self._memory = LiveMemory()

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
