"""What it costs to turn things on: CPU of the node for each message at 1 kHz, against the node as it is."""

from benchmarks.bench.given import Given
from benchmarks.bench.messages import CPU_RATE, TRIAL_SECONDS, imu_peer
from benchmarks.bench.processes import node_command, started
from benchmarks.bench.row import Result, Row
from benchmarks.bench.trials import stream_through, warm_up

GROUP, RIVAL = "options", "node by default"
MOST_REPETITIONS = 3
"""At most: these rows only inform."""


def measure(given: Given) -> Result:
    """Return a row for each thing that can be turned on."""
    plain = given.calibrations.plain()
    commands = {
        "a state with every sample (state_rate 0)": node_command(plain, "state_rate:=0.0"),
        "filter smooth": node_command(given.calibrations.smooth()),
        "three effects": node_command(given.calibrations.with_effects()),
        RIVAL: node_command(plain),
    }
    cpu: dict[str, list[float]] = {name: [] for name in commands}
    repetitions = min(given.repetitions, MOST_REPETITIONS)
    for repetition in range(repetitions):
        for name, command in commands.items():
            cpu[name].append(1e6 * _cpu_per_message(command))
            given.say(f"options {repetition + 1}/{repetitions} {name}: {cpu[name][-1]:.1f} µs")
    return Result(
        tuple(
            Row(GROUP, f"CPU per message at 1 kHz, {name}", "µs", RIVAL, tuple(values), tuple(cpu[RIVAL]))
            for name, values in cpu.items()
            if name != RIVAL
        )
    )


def _cpu_per_message(command: list[str]) -> float:
    """Return s of processor time."""
    with started(command) as process, imu_peer() as peer:
        warm_up(peer, process)
        return stream_through(peer, process, CPU_RATE, TRIAL_SECONDS).cpu_per_message
