"""One message for each sample: the node against a plain relay of the same messages."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict
from subprocess import Popen

import numpy as np
from sensor_msgs.msg import Imu

from benchmarks.bench.given import Given
from benchmarks.bench.peer import Peer
from benchmarks.bench.processes import node_command, relay_command, started
from benchmarks.bench.row import Result, Row, Target
from benchmarks.bench.search import AGAIN, FIRST, Search
from benchmarks.bench.trials import Trial, latencies, stream_through, warm_up
from hgma_compensation import topics
from hgma_compensation.node.interfaces import input_qos

GROUP, RIVAL = "messages", "plain relay"
TRIAL_SECONDS, CPU_SECONDS, LATENCY_SECONDS = 5.0, 10.0, 10.0
CPU_RATE, LATENCY_RATE = 1000.0, 200.0
FIRST_RATES = {"ours": 4000.0, "rival": 500.0, "deep": 2000.0}
"""At which each search begins, messages/s."""

PLAIN_DEPTH, DEEP_REPETITIONS = 10, 3
"""Depth of both queues in what everybody copies from the tutorials of rclpy, reliable both; and how often the relay
whose queues are as deep as the node's is measured at the most."""


def measure(given: Given) -> Result:
    """Return the rows of the message path."""
    commands = {
        "ours": node_command(given.calibrations.plain()),
        "rival": relay_command("imu", PLAIN_DEPTH, "reliable"),
        "deep": relay_command("imu", input_qos(topics.RAW).depth),
    }
    sides = {side: Side(command, FIRST_RATES[side], changes=side == "ours") for side, command in commands.items()}
    for repetition in range(given.repetitions):
        for name, side in sides.items():
            if name == "deep" and repetition >= DEEP_REPETITIONS:
                continue
            side.run(rate_only=name == "deep")
            given.say(f"messages {repetition + 1}/{given.repetitions} {name}: {side.said()}")
    ours, rival, deep = sides["ours"], sides["rival"], sides["deep"]
    limited = ours.limited_by_source
    note = f"limited by the source in {limited} of {given.repetitions}" if limited else ""

    def row(name: str, unit: str, values: Callable[[Side], list[float]], target: Target | None, note: str = "") -> Row:
        return Row(GROUP, name, unit, RIVAL, tuple(values(ours)), tuple(values(rival)), target, note)

    def beside(name: str, unit: str, values: Callable[[Side], list[float]]) -> Row:
        measured = tuple(values(deep))
        return Row(GROUP, name, unit, "relay, queues as deep", tuple(values(ours))[: len(measured)], measured)

    rows = (
        row("sustained rate without loss", "1/s", lambda s: s.rates, Target(15.0, at_least=True), note),
        row("CPU per message at 1 kHz", "µs", lambda s: s.cpu_at_1_khz, Target(0.7)),
        row("CPU per message, each at its highest rate", "µs", lambda s: s.cpu_at_highest, Target(0.1)),
        row("median latency at 200 Hz", "ms", lambda s: s.latency_median, Target(1.0)),
        row("99 % latency at 200 Hz", "ms", lambda s: s.latency_99, None),
        beside("sustained rate without loss", "1/s", lambda s: s.rates),
        beside("CPU per message, each at its highest rate", "µs", lambda s: s.cpu_at_highest),
    )
    return Result(rows, {name: [asdict(trial) for trial in side.trials] for name, side in sides.items()})


class Side:
    """One of the two, and its figures of each repetition."""

    def __init__(self, command: list[str], first_rate: float, *, changes: bool) -> None:
        """Take the command, the rate to begin the search at, and whether each acceleration must come back changed."""
        self._command, self._first, self._changes = command, first_rate, changes
        self._search = FIRST
        self.limited_by_source = 0
        self.trials: list[Trial] = []
        self.rates: list[float] = []
        self.cpu_at_1_khz: list[float] = []
        self.cpu_at_highest: list[float] = []
        self.latency_median: list[float] = []
        self.latency_99: list[float] = []

    def said(self) -> str:
        """Return the last repetition in a line."""
        said = f"{self.rates[-1]:.0f}/s, {self.cpu_at_highest[-1]:.1f} µs each there"
        if self.latency_median:
            said += f", {self.cpu_at_1_khz[-1]:.1f} µs at 1 kHz"
            said += f", latency {self.latency_median[-1]:.3f} ms, 99 % {self.latency_99[-1]:.3f} ms"
        return said

    def run(self, *, rate_only: bool = False) -> None:
        """Start the process and measure its highest rate, and the rest before it."""
        with started(self._command) as process, imu_peer() as peer:
            warm_up(peer, process)
            if not rate_only:
                self._measure_slow(peer, process)
            self._find_highest(peer, process, self._search)
            self._search = AGAIN

    def _measure_slow(self, peer: Peer, process: Popen[bytes]) -> None:
        times = 1e3 * latencies(peer, LATENCY_RATE, LATENCY_SECONDS)
        self.latency_median.append(float(np.median(times)))
        self.latency_99.append(float(np.percentile(times, 99.0)))
        self.cpu_at_1_khz.append(1e6 * self._trial(peer, process, CPU_RATE, CPU_SECONDS).cpu_per_message)

    def _find_highest(self, peer: Peer, process: Popen[bytes], search: Search) -> None:
        trials: list[Trial] = []

        def sustained(rate: float) -> bool:
            trials.append(self._trial(peer, process, rate, TRIAL_SECONDS))
            return trials[-1].sustained

        self._first = search.highest_rate(sustained, self._first)
        best = next(trial for trial in trials if trial.rate == self._first and trial.sustained)
        self.rates.append(best.rate)
        self.cpu_at_highest.append(1e6 * best.cpu_per_message)
        self.limited_by_source += source_was_the_limit(trials, best.rate)

    def _trial(self, peer: Peer, process: Popen[bytes], rate: float, seconds: float) -> Trial:
        trial = stream_through(peer, process, rate, seconds)
        peer.forget()
        came = trial.sent - trial.lost
        if trial.changed != (came if self._changes else 0):
            raise RuntimeError(f"{trial.changed} of {came} accelerations came back changed: {' '.join(self._command)}")
        self.trials.append(trial)
        return trial


def source_was_the_limit(trials: Sequence[Trial], highest: float) -> bool:
    """Return whether at the next rate that was tried above the highest sustained one the source fell behind, always."""
    above = [trial for trial in trials if trial.rate > highest]
    lowest = min((trial.rate for trial in above), default=highest)
    return bool(above) and not any(trial.source_kept for trial in above if trial.rate == lowest)


@contextmanager
def imu_peer() -> Iterator[Peer]:
    """Give the other end of the message topics."""
    peer = Peer(Imu, topics.RAW, topics.COMPENSATED)
    try:
        yield peer
    finally:
        peer.close()
