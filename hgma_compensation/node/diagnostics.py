"""The node's state in words, as diagnostic_msgs."""

from collections.abc import Sequence
from typing import Protocol

from diagnostic_msgs.msg import DiagnosticStatus, KeyValue

from hgma_compensation.pipeline.live import LiveCompensation
from hgma_compensation.pipeline.reasons import REMEDIES, Skip
from hgma_compensation.pipeline.status import TemperatureStatus

LONGEST_UNCHANGED = 600.0
"""s after which one and the same value of the thermistor is worth a remark."""


class Reporter(Protocol):
    """A part of the node that has something of its own to say in the diagnostics."""

    def problems(self) -> list[str]:
        """Return what is wrong, each with what to do."""
        ...

    def values(self) -> list[tuple[str, str]]:
        """Return figures by name."""
        ...


class DiagnosticReport:
    """Turns counts into a status; remembers them to tell what is new since the report before."""

    def __init__(self, name: str, reporters: Sequence[Reporter] = ()) -> None:
        """Report under a name, for the parts of the node too that have something to say."""
        self._name, self._reporters = name, reporters
        self._reported: dict[str, int] = {}
        self._received = self._heard = 0

    def status(self, live: LiveCompensation, state: str, refusal: str, elapsed: float) -> DiagnosticStatus:
        """Return the status of the last ``elapsed`` seconds.

        state: of the lifecycle. refusal: why the last calibration was refused, "" if it was not.
        """
        fresh = {name: count - self._reported.get(name, 0) for name, count in live.counts.items()}
        values = self._values(live, state, refusal, elapsed)
        self._reported, self._received, self._heard = dict(live.counts), live.received, live.temperatures
        error, problems = self._problems(live, state, refusal, {n: c for n, c in fresh.items() if c})
        level = DiagnosticStatus.ERROR if error else DiagnosticStatus.WARN if problems else DiagnosticStatus.OK
        return DiagnosticStatus(
            level=level,
            name=self._name,
            message="; ".join(problems) or "compensating",
            hardware_id=live.calibration.sensor_id if live.calibration else "",
            values=[KeyValue(key=key, value=value) for key, value in values],
        )

    def _problems(
        self, live: LiveCompensation, state: str, refusal: str, fresh: dict[str, int]
    ) -> tuple[bool, list[str]]:
        """Return whether there is no output at all, and each problem with its remedy, the worst first."""
        others = [problem for reporter in self._reporters for problem in reporter.problems()]
        if live.calibration is None:
            return True, [refusal or f"no calibration: {REMEDIES[Skip.NO_CALIBRATION.value]}", *others]
        if state != "active":
            return False, [f"the node is {state}: {REMEDIES[Skip.NOT_ACTIVE.value]}", *others]
        problems = [f"the new calibration was refused, the old one is used: {refusal}"] if refusal else []
        problems += live.observer.problems() if live.observer else []
        for name, count in sorted(fresh.items(), key=lambda item: -item[1]):
            problems.append(f"{name} ({count} since the last report): {REMEDIES[name]}")
        if live.last_result is None:
            problems.append("no acceleration yet: check the topic accel/raw")
        elif live.observer and (unchanged := live.observer.temperature_unchanged) > LONGEST_UNCHANGED:
            problems.append(f"the thermistor has shown exactly one value for {unchanged:.0f} s: check that it measures")
        return False, problems + others

    def _values(self, live: LiveCompensation, state: str, refusal: str, elapsed: float) -> list[tuple[str, str]]:
        # After a jump back of the node's clock there is no rate.
        rates = [
            (count - before) / elapsed if elapsed > 0.0 else 0.0
            for count, before in ((live.received, self._received), (live.temperatures, self._heard))
        ]
        values = [
            ("lifecycle_state", state),
            ("calibration_id", live.calibration.calibration_id if live.calibration else ""),
            ("last_refusal", refusal),
            ("samples_per_second", f"{rates[0]:.1f}"),
            ("temperatures_per_second", f"{rates[1]:.1f}"),
            ("samples_received", str(live.received)),
            ("samples_compensated", str(live.compensated)),
            ("samples_skipped", str(live.skipped())),
            ("gate_openings", str(live.gate_openings)),
        ]
        if live.last_result is not None:
            result = live.last_result.compensated
            values += [
                ("temperature_status", TemperatureStatus(int(result.status[-1])).name),
                ("temperature_celsius", f"{result.features[-1, 0]:.3f}"),
                ("inside_calibrated_range", str(bool(result.inside_range[-1]))),
            ]
        values.append(("missing_inputs", ", ".join(need.value for need in live.missing_inputs)))
        values += live.observer.values() if live.observer else []
        values += [value for reporter in self._reporters for value in reporter.values()]
        return values + [(name, str(count)) for name, count in sorted(live.counts.items())]
