"""From the start of a process to its first output, with a stream that runs already."""

import compileall
import json
import os
import subprocess
import sys
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path

import hgma_compensation
from benchmarks.bench.given import Given
from benchmarks.bench.one_start import Start, profile
from benchmarks.bench.processes import node_command, relay_command
from benchmarks.bench.row import Result, Row, Target, transposed
from hgma_compensation import topics
from hgma_compensation.node.interfaces import input_qos

GROUP, RIVAL = "start", "empty rclpy node"

LEAST_REPETITIONS = 15
"""At least: a start takes half a second, in which the machine does other things too."""

MEMORY_REPETITIONS, AFTER = 3, 2.0
"""How often the memory is read, which hardly varies, and s after the first output at which it is."""


def measure(given: Given) -> Result:
    """Return the rows of start and memory."""
    node = node_command(given.calibrations.plain())
    relay = relay_command("imu", input_qos(topics.RAW).depth)
    _compile()
    environment = os.environ | profile(given.scratch)
    repetitions = max(given.repetitions, LEAST_REPETITIONS)
    turns: list[tuple[Start, Start]] = []
    for repetition in range(repetitions):
        after = AFTER if repetition < MEMORY_REPETITIONS else 0.0
        ours, rival = _start(node, environment, after, ours=True), _start(relay, environment, after, ours=False)
        turns.append((ours, rival))
        given.say(f"start {repetition + 1}/{repetitions}: {ours.seconds:.3f} s; {RIVAL} {rival.seconds:.3f} s")

    def row(name: str, unit: str, figure: Callable[[Start], float], target: Target | None, most: int) -> Row:
        values = transposed([(figure(ours), figure(rival)) for ours, rival in turns[:most]])
        return Row(GROUP, name, unit, RIVAL, *values, target)

    rows = (
        row("process start to first output, stream at 1 kHz", "s", lambda s: s.seconds, Target(1.3), repetitions),
        row("processor time until then, all threads", "s", lambda s: s.processor, None, repetitions),
        row("peak resident memory, children included", "MB", lambda s: s.peak_megabytes, None, MEMORY_REPETITIONS),
    )
    return Result(rows, {"starts": [[asdict(start) for start in turn] for turn in turns]})


def _compile() -> None:
    """Compile this package as pip compiles what it installs, the rival's packages too; it may lie here as sources."""
    if not compileall.compile_dir(Path(hgma_compensation.__file__).parent, quiet=1):
        raise RuntimeError("hgma_compensation cannot be compiled")


def _start(command: list[str], environment: dict[str, str], after: float, *, ours: bool) -> Start:
    """Return the figures of one start; raises RuntimeError with what was said where there was none."""
    words = [sys.executable, "-m", "benchmarks.bench.one_start", str(ours), str(after), *command]
    done = subprocess.run(words, env=environment, capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(f"{' '.join(command)}: {done.stderr.strip()}")
    return Start(**json.loads(done.stdout.splitlines()[-1]))
