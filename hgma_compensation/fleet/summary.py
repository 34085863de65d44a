"""A whole fleet: which sensors are accepted, which are the worst, which are unlike the rest."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Any

import numpy as np

from hgma_compensation import __version__
from hgma_compensation.channels import CHANNELS, unit_of
from hgma_compensation.fleet.figures import BY_NAME, FIGURES
from hgma_compensation.fleet.limits import Broken, Limits
from hgma_compensation.fleet.options import FleetOptions
from hgma_compensation.fleet.outliers import outlying, robust_scores
from hgma_compensation.fleet.status import Status

RANKED_BY = "residual_standard_deviation"
"""Figure that ranks sensors where there are no limits."""

BEYOND = 1e9
"""Badness of a figure that has a limit and is not defined."""


class State(str, Enum):
    """ACCEPTED: keeps every limit. REJECTED: breaks one. CALIBRATED: no limit judges it. FAILED: no calibration."""

    ACCEPTED = "accepted"
    REJECTED = "rejected"
    CALIBRATED = "calibrated"
    FAILED = "failed"


@dataclass(frozen=True)
class Outlier:
    """A figure of a sensor that is unlike the fleet's; score: robust, beyond 3.5 on either side."""

    channel: str
    figure: str
    value: float
    score: float


@dataclass(frozen=True)
class Unit:
    """One sensor among the others. badness: 1 at a limit, or at the fleet's median where there are no limits."""

    status: Status
    state: State
    broken: tuple[Broken, ...]
    outliers: tuple[Outlier, ...]
    badness: float

    @property
    def name(self) -> str:
        """The sensor's name."""
        return self.status.sensor


@dataclass(frozen=True)
class Summary:
    """units: in the order of their names. unused: sections of the limits that no sensor has a channel for."""

    units: tuple[Unit, ...]
    limits: Limits
    options: FleetOptions
    unused: tuple[str, ...]

    @property
    def channels(self) -> tuple[str, ...]:
        """Channels that any sensor has."""
        return tuple(c for c in CHANNELS if any(c in unit.status.channels for unit in self.units))

    def count(self, state: State) -> int:
        """Return the number of sensors in a state."""
        return sum(unit.state is state for unit in self.units)

    @property
    def accepted_share(self) -> float | None:
        """Accepted sensors over all, also those that could not be calibrated; None where there are no limits."""
        return self.count(State.ACCEPTED) / len(self.units) if self.limits else None

    @property
    def worst(self) -> tuple[Unit, ...]:
        """Calibrated sensors, the worst first."""
        calibrated = [unit for unit in self.units if unit.status.calibrated]
        return tuple(sorted(calibrated, key=lambda unit: (-unit.badness, unit.name)))

    @property
    def failed(self) -> tuple[Unit, ...]:
        """Sensors that could not be calibrated."""
        return tuple(unit for unit in self.units if unit.state is State.FAILED)

    def values(self, channel: str, figure: str) -> list[float | None]:
        """Return a figure of every sensor, None where it has none."""
        return [unit.status.channels.get(channel, {}).get(figure) for unit in self.units]

    def broken_by(self, channel: str, figure: str) -> int:
        """Return the number of sensors that break the limit of a figure."""
        return sum((one.channel, one.figure) == (channel, figure) for unit in self.units for one in unit.broken)

    def as_json(self) -> dict[str, Any]:
        """Return the summary in the form that scripts rely on; no clock and no path in it."""
        return {
            "tool": f"hgma_compensation {__version__}",
            "options": self.options.as_json(),
            "limits": self.limits.sections,
            "counts": {"sensors": len(self.units), **{state.value: self.count(state) for state in State}},
            "yield": self.accepted_share,
            "channels": {channel: self._channel_json(channel) for channel in self.channels},
            "worst": [unit.name for unit in self.worst[:20]],
            "sensors": {unit.name: _unit_json(unit) for unit in self.units},
        }

    def _channel_json(self, channel: str) -> dict[str, Any]:
        limits = self.limits.of(channel)
        result: dict[str, Any] = {"unit": unit_of(channel), "figures": {}}
        for figure in FIGURES:
            known = [value for value in self.values(channel, figure.name) if value is not None]
            if known:
                result["figures"][figure.name] = {
                    "unit": figure.unit(unit_of(channel)),
                    "median": float(np.median(known)),
                    "minimum": min(known),
                    "maximum": max(known),
                    "limit": limits.get(figure.name),
                    "broken_by": self.broken_by(channel, figure.name),
                }
        return result


def summarise(statuses: Sequence[Status], limits: Limits, options: FleetOptions) -> Summary:
    """Return the summary of a fleet; it depends on neither the order of the sensors nor on where they were computed."""
    ordered = sorted(statuses, key=lambda status: status.sensor)
    outliers = _outliers(ordered)
    medians = _medians(ordered)
    units = []
    for status in ordered:
        broken = limits.broken(status.channels)
        units.append(
            Unit(
                status=status,
                state=_state(status, limits, broken),
                broken=broken,
                outliers=tuple(outliers[status.sensor]),
                badness=_badness(status, limits, medians),
            )
        )
    present = {channel for status in ordered for channel in status.channels}
    unused = tuple(name for name in limits.sections if not any(channel.startswith(name) for channel in present))
    return Summary(tuple(units), limits, options, unused)


def _state(status: Status, limits: Limits, broken: Sequence[Broken]) -> State:
    if not status.calibrated:
        return State.FAILED
    if broken:
        return State.REJECTED
    return State.ACCEPTED if limits.judges(status.channels) else State.CALIBRATED


def _outliers(statuses: Sequence[Status]) -> dict[str, list[Outlier]]:
    found: dict[str, list[Outlier]] = {status.sensor: [] for status in statuses}
    for channel in CHANNELS:
        for figure in FIGURES:
            raw = [status.channels.get(channel, {}).get(figure.name) for status in statuses]
            values = np.array([np.nan if value is None else value for value in raw])
            scores = robust_scores(values)
            for row in np.flatnonzero(outlying(scores, figure.worse)).tolist():
                one = Outlier(channel, figure.name, float(values[row]), float(scores[row]))
                found[statuses[row].sensor].append(one)
    return found


def _medians(statuses: Sequence[Status]) -> dict[str, float]:
    """Return by channel the median of the figure that ranks."""
    result = {}
    for channel in CHANNELS:
        known = [status.channels[channel][RANKED_BY] for status in statuses if channel in status.channels]
        finite = [value for value in known if value is not None]
        if finite:
            result[channel] = float(np.median(finite))
    return result


def _badness(status: Status, limits: Limits, medians: Mapping[str, float]) -> float:
    shares = [0.0]
    for channel, figures in status.channels.items():
        for name, limit in limits.of(channel).items():
            value, figure = figures[name], BY_NAME[name]
            shares.append(
                float(np.finfo(float).max) if value is None else figure.badness(value) / figure.badness(limit)
            )
        value = figures[RANKED_BY]
        if not limits and value is not None and medians[channel] > 0.0:
            shares.append(value / medians[channel])
    return max(shares)


def _unit_json(unit: Unit) -> dict[str, Any]:
    judged = unit.status.judged
    return {
        "state": unit.state.value,
        "reason": unit.status.reason or None,
        "calibration_id": None if judged is None else judged.calibration_id,
        "trained_on": [] if judged is None else list(judged.trained_on),
        "judged_on": None if judged is None else judged.judged_on,
        "judged_from": None if judged is None else judged.limit,
        "reference": None if judged is None else judged.reference,
        "broken": [
            {"channel": one.channel, "figure": one.figure, "value": one.value, "limit": one.limit}
            for one in unit.broken
        ],
        "outliers": [
            {"channel": one.channel, "figure": one.figure, "value": one.value, "score": one.score}
            for one in unit.outliers
        ],
        "channels": unit.status.channels,
    }
