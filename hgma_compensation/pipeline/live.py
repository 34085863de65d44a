"""A pipeline that lives in a node: swaps calibrations, remembers the slow inputs, counts what it skips."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.channels import columns_of
from hgma_compensation.effects.effect import Need
from hgma_compensation.pipeline.compensated import Compensated
from hgma_compensation.pipeline.pipeline import Pipeline
from hgma_compensation.pipeline.prepared import Histories, Prepared, prepare
from hgma_compensation.pipeline.reasons import LATE, MISSING, Note, Skip, sample_name
from hgma_compensation.pipeline.remembered import Remembered
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
        """Return a copy of what is remembered of the slow inputs, for ``prepare`` in another thread."""
        return {need: remembered.history() for need, remembered in self._remembered.items()}

    def adopt(self, prepared: Prepared) -> None:
        """Use what was prepared from the next sample on, as if it had been installed when its histories were taken.

        Memories of the acceleration that it shares with the calibration before it go on. Where the history began anew
        in the meantime, it is prepared again.
        """
        if not prepared.follows(self._remembered):
            prepared = prepare(prepared.pipeline.calibration, self.histories())
        prepared.catch_up(self._remembered)
        if self._pipeline is not None:
            prepared.pipeline.succeed(self._pipeline)
        self._pipeline = prepared.pipeline

    def remove_calibration(self) -> None:
        """Drop the calibration; samples are skipped until another is installed."""
        self._pipeline = None
        self.last_result = None

    def reset(self) -> None:
        """Forget the history of all inputs, memories and filter states; calibration and counts stay."""
        for samples in self._remembered.values():
            samples.clear()
        self._last_acceleration = None
        if self._pipeline is not None:
            self._pipeline.reset()

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
