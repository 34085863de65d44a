"""Whether the calibration in use still describes the sensor: its noise by the innovations, its drift by the rest."""

from collections import deque

from hgma_compensation.channels import unit_of
from hgma_compensation.kalman.consistency import Consistency
from hgma_compensation.pipeline.pipeline import Pipeline
from hgma_compensation.pipeline.rest_monitor import Residual, RestMonitor

REPORTS = 60
"""Calls over which the innovations are averaged: a minute of reports."""

FEWEST = 500
"""Innovations below which their mean square says little: its deviation is then 6 %."""

CONSISTENT = (0.25, 4.0)
"""Of the NIS: beyond it the noise is not within a factor of two of the calibration's."""


class Health:
    """Follows one calibration; ``update`` once for each report, then read ``problems`` and ``values``."""

    def __init__(self, pipeline: Pipeline, rest: RestMonitor) -> None:
        """Take what runs under the calibration."""
        self._pipeline, self._rest = pipeline, rest
        self._names = pipeline.calibration.names
        self._taken: list[deque[Consistency]] = [deque(maxlen=REPORTS) for _ in self._names]

    def update(self) -> None:
        """Take in what came since the last call."""
        for taken, now in zip(self._taken, self._pipeline.take_consistency(), strict=True):
            taken.append(now)

    def consistency(self) -> dict[str, float]:
        """Return the mean normalised innovation squared of the channels that have enough of them, 1 as it should be."""
        found = {}
        for name, taken in zip(self._names, self._taken, strict=True):
            count = sum(part.closed for part in taken)
            if count >= FEWEST:
                found[name] = sum(part.squares for part in taken) / count
        return found

    def open_fraction(self) -> dict[str, float]:
        """Return the fraction of samples during which the gate of the channels that have one was open."""
        found = {}
        for name, taken in zip(self._names, self._taken, strict=True):
            count = sum(part.closed + part.open for part in taken)
            if count:
                found[name] = sum(part.open for part in taken) / count
        return found

    def problems(self) -> list[str]:
        """Return what is wrong and what to do."""
        found = [_noise_problem(name, nis) for name, nis in self.consistency().items() if not _consistent(nis)]
        return [_fit_problem(residual) for residual in self._rest.residuals() if not residual.fits] + found

    def values(self) -> list[tuple[str, str]]:
        """Return the figures."""
        found = [(f"nis_{name}", f"{nis:.3f}") for name, nis in self.consistency().items()]
        found += [(f"gate_open_{name}", f"{fraction:.3f}") for name, fraction in self.open_fraction().items()]
        for residual in self._rest.residuals():
            found.append((f"rest_residual_{residual.channel}", f"{residual.rms:.4g}"))
            found.append((f"rest_level_{residual.channel}", f"{residual.level:.4g}"))
            found.append((f"calibration_error_{residual.channel}", f"{residual.own:.4g}"))
        return found


def _consistent(nis: float) -> bool:
    return CONSISTENT[0] <= nis <= CONSISTENT[1]


def _noise_problem(name: str, nis: float) -> str:
    return (
        f"the noise of {name} is {nis**0.5:.2g} times that of the calibration (NIS {nis:.2g}): "
        "check the sensor's mounting and range, or train again with a recording at rest"
    )


def _fit_problem(residual: Residual) -> str:
    unit = unit_of(residual.channel)
    return (
        f"this calibration no longer fits this sensor: {residual.channel} at rest is {residual.level:.3g} {unit} off, "
        f"wanders by {residual.rms:.3g} {unit} RMS, its own error is {residual.own:.3g} {unit}: "
        "record it at rest over its temperatures and run hgma diagnose BAG --calibration FILE -o DIR"
    )
