"""The node's state in words, as diagnostic_msgs."""

from diagnostic_msgs.msg import DiagnosticStatus, KeyValue

from hgma_compensation.node.state_keeper import MemoryFindings
from hgma_compensation.pipeline.live import LiveCompensation
from hgma_compensation.pipeline.reasons import REMEDIES, Skip
from hgma_compensation.pipeline.status import TemperatureStatus

TEMPERATURE_ADVICE = {
    TemperatureStatus.SETTLING: "temperature history is settling, the drift is approximate",
    TemperatureStatus.STALE: "the thermistor is silent, its last trend is held: check its driver",
    TemperatureStatus.MISSING: "no thermistor sample yet, the drift at mid-range is subtracted: "
    "check the topic accel/temperature",
    TemperatureStatus.OUT_OF_RANGE: "temperature outside the calibrated range, drift held at its edge: "
    "calibrate over a wider range",
}


class DiagnosticReport:
    """Turns counts into a status; remembers them to tell what is new since the report before."""

    def __init__(self, name: str) -> None:
        """Report under a name."""
        self._name = name
        self._reported: dict[str, int] = {}
        self._received = 0

    def status(
        self, live: LiveCompensation, state: str, refusal: str, elapsed: float, memory: MemoryFindings
    ) -> DiagnosticStatus:
        """Return the status of the last ``elapsed`` seconds.

        state: of the lifecycle. refusal: why the last calibration was refused, "" if it was not. memory: what there is
        to say of the memories and their file.
        """
        fresh = {name: count - self._reported.get(name, 0) for name, count in live.counts.items()}
        rate = (live.received - self._received) / elapsed if elapsed > 0.0 else 0.0
        self._reported, self._received = dict(live.counts), live.received
        error, problems = self._problems(live, state, refusal, {n: c for n, c in fresh.items() if c})
        problems += memory.problems
        level = DiagnosticStatus.ERROR if error else DiagnosticStatus.WARN if problems else DiagnosticStatus.OK
        values = self._values(live, state, refusal, rate) + memory.values
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
        if live.calibration is None:
            return True, [refusal or f"no calibration: {REMEDIES[Skip.NO_CALIBRATION.value]}"]
        if state != "active":
            return False, [f"the node is {state}: {REMEDIES[Skip.NOT_ACTIVE.value]}"]
        problems = [f"the new calibration was refused, the old one is used: {refusal}"] if refusal else []
        for name, count in sorted(fresh.items(), key=lambda item: -item[1]):
            problems.append(f"{name} ({count} since the last report): {REMEDIES[name]}")
        if live.last_result is None:
            problems.append("no acceleration yet: check the topic accel/raw")
        elif (status := TemperatureStatus(int(live.last_result.compensated.status[-1]))) in TEMPERATURE_ADVICE:
            problems.append(TEMPERATURE_ADVICE[status])
        return False, problems

    def _values(self, live: LiveCompensation, state: str, refusal: str, rate: float) -> list[tuple[str, str]]:
        values = [
            ("lifecycle_state", state),
            ("calibration_id", live.calibration.calibration_id if live.calibration else ""),
            ("last_refusal", refusal),
            ("samples_per_second", f"{rate:.1f}"),
            ("samples_received", str(live.received)),
            ("samples_compensated", str(live.compensated)),
            ("samples_skipped", str(live.skipped())),
            ("gate_openings", str(live.gate_openings)),
        ]
        if live.last_result is not None:
            result = live.last_result.compensated
            values.append(("temperature_status", TemperatureStatus(int(result.status[-1])).name))
            values.append(("temperature_celsius", f"{result.features[-1, 0]:.3f}"))
            values.append(("inside_calibrated_range", str(bool(result.inside_range[-1]))))
        values.append(("missing_inputs", ", ".join(need.value for need in live.missing_inputs)))
        return values + [(name, str(count)) for name, count in sorted(live.counts.items())]
