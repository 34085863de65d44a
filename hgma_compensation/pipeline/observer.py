"""Watches a live pipeline: counts what its results say of the inputs, and judges whether the calibration fits."""

from collections import Counter
from math import inf

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.effects.effect import Need
from hgma_compensation.pipeline.compensated import Compensated
from hgma_compensation.pipeline.health import Health
from hgma_compensation.pipeline.inputs import ACCELERATION_LAG
from hgma_compensation.pipeline.ordinary_block import BlockSums
from hgma_compensation.pipeline.pipeline import Pipeline
from hgma_compensation.pipeline.reasons import MISSING, STALE, Note, status_name
from hgma_compensation.pipeline.rest_monitor import RestMonitor, Temperatures
from hgma_compensation.pipeline.status import TemperatureStatus
from hgma_compensation.stamps import Stamps, to_nanoseconds
from hgma_compensation.temperature.updates import POWER_OFF

LONGEST_LEAD = to_nanoseconds(ACCELERATION_LAG)
"""ns that a slow input may be ahead of the accelerometer without its history being dropped."""


class Observer:
    """Of one pipeline, from the moment at which it is used."""

    def __init__(self, pipeline: Pipeline, counts: Counter[str]) -> None:
        """Count into ``counts``."""
        self._pipeline, self._counts = pipeline, counts
        self._rest = RestMonitor(pipeline.calibration)
        self._health = Health(pipeline, self._rest)

    def reset(self) -> None:
        """Forget what the sensor showed at rest."""
        self._rest.reset()

    def observe(self, stamps: Stamps, result: Compensated) -> None:
        """Take what became of samples at stamps (n > 0,) in ns."""
        if self._pipeline.cuts:
            for cut in list(self._pipeline.cuts):
                self._counts[cut.value] += self._pipeline.cuts.pop(cut)
        usable = result.ordinary or self._usable(result.status)
        for need in self._pipeline.inputs.wanted:
            note, count = _absence(need, self._pipeline.inputs.updates(need).last, stamps)
            if count:
                self._counts[note.value] += count
        self._rest.take(stamps, result.unfiltered, result, usable=usable)

    def has_nothing_to_say(self, first: int, last: int) -> bool:
        """Return whether nothing but its status is to be said of any sample from ``first`` to ``last`` (ns)."""
        newest = [(need, self._pipeline.inputs.updates(need).last) for need in self._pipeline.inputs.wanted]
        return not self._pipeline.cuts and all(
            at is not None and (at - first <= LONGEST_LEAD if need is None else last - at <= POWER_OFF)
            for need, at in newest
        )

    def observe_block(self, first: int, last: int, sums: BlockSums, at: Temperatures) -> None:
        """Take samples of which nothing else is to be said, from ``first`` to ``last`` (ns), by their sums."""
        for status, count in sums.statuses.items():
            self._counts[status_name(TemperatureStatus(status))] += count
        self._rest.take_sums(first, last, sums, at)

    def silent_until(self, until: int) -> bool:
        """Return whether no sample from the newest one to a stamp (ns) has anything to be said of but itself."""
        newest = self._pipeline.newest
        if newest is None:
            return False
        found = [(need, self._pipeline.inputs.updates(need).last) for need in self._pipeline.inputs.wanted]
        return all(
            last is not None and (last - newest <= LONGEST_LEAD if need is None else until - last <= POWER_OFF)
            for need, last in found
        )

    def goes_on(self, stamp: int) -> bool:
        """Return whether ``observe_one`` may take a sample at a stamp, ns."""
        return self._rest.goes_on(stamp)

    def observe_one(self, corrected: list[float]) -> None:
        """Take a sample (c,) of which nothing is to be said, less its drift."""
        self._rest.add_one(corrected)

    def _usable(self, status: NDArray[np.uint8]) -> bool:
        """Count each status (n,) but OK, and return whether there is no other."""
        found = np.bincount(status).tolist()
        for number, count in enumerate(found[1:], start=1):
            if count:
                self._counts[status_name(TemperatureStatus(number))] += count
        return len(found) == 1

    @property
    def temperature_unchanged(self) -> float:
        """For how long (s) the thermistor has shown exactly the same value."""
        newest = self._pipeline.newest
        return 0.0 if newest is None else self._pipeline.track.unchanged(newest)

    @property
    def thermistor_behind(self) -> float:
        """By how much (s) the thermistor's newest stamp is behind the accelerometer's; infinite without one."""
        newest, last = self._pipeline.newest, self._pipeline.track.last
        return inf if newest is None or last is None else (newest - last) * 1e-9

    def problems(self) -> list[str]:
        """Return what says that the calibration does not fit the sensor; once for each report."""
        self._health.update()
        return self._health.problems()

    def values(self) -> list[tuple[str, str]]:
        """Return the figures behind ``problems``, by name."""
        return [("thermistor_behind_seconds", f"{self.thermistor_behind:.3f}"), *self._health.values()]


def _absence(need: Need | None, last: int | None, stamps: Stamps) -> tuple[Note, int]:
    """Return what may be said of an input whose newest sample came at ``last``, and of how many samples it is true."""
    if need is None:
        if last is None or last - int(stamps[0]) <= LONGEST_LEAD:
            return Note.TEMPERATURE_AHEAD, 0
        return Note.TEMPERATURE_AHEAD, int(np.count_nonzero(last - stamps > LONGEST_LEAD))
    if last is None:
        return MISSING[need], len(stamps)
    return STALE[need], int(np.count_nonzero(stamps - last > POWER_OFF))
