"""From the start of a process to its first output, with a stream that runs already."""

import compileall
import time
from dataclasses import asdict, dataclass
from pathlib import Path

import hgma_compensation
from benchmarks.bench.given import Given
from benchmarks.bench.imu_stream import ImuStream
from benchmarks.bench.messages import imu_peer
from benchmarks.bench.pace import send_evenly
from benchmarks.bench.peer import Peer
from benchmarks.bench.processes import node_command, peak_megabytes, relay_command, started
from benchmarks.bench.row import Result, Row, Target, transposed
from benchmarks.bench.trials import TIMEOUT
from hgma_compensation import topics
from hgma_compensation.node.interfaces import input_qos

GROUP, RIVAL = "start", "empty rclpy node"
RATE, THERMISTOR_RATE = 1000.0, 100.0
"""Hz; a thermistor so fast that a node does not wait for it."""

AFTER = 2.0
"""s after the first output at which the memory is read."""


@dataclass(frozen=True)
class Start:
    """seconds: to the first output, ours compensated. peak_megabytes: of process and children, a while later."""

    seconds: float
    peak_megabytes: float


def measure(given: Given) -> Result:
    """Return the rows of start and memory."""
    commands = (node_command(given.calibrations.plain()), relay_command("imu", input_qos(topics.RAW).depth))
    _compile()
    turns = []
    for repetition in range(given.repetitions):
        ours, rival = _start(commands[0], compensates=True), _start(commands[1], compensates=False)
        turns.append((ours, rival))
        given.say(
            f"start {repetition + 1}/{given.repetitions}: {ours.seconds:.3f} s, {ours.peak_megabytes:.0f} MB; "
            f"{RIVAL} {rival.seconds:.3f} s, {rival.peak_megabytes:.0f} MB"
        )
    seconds = transposed([(ours.seconds, rival.seconds) for ours, rival in turns])
    memory = transposed([(ours.peak_megabytes, rival.peak_megabytes) for ours, rival in turns])
    first = "process start to first output, stream at 1 kHz"
    rows = (
        Row(GROUP, first, "s", RIVAL, *seconds, Target(1.3)),
        Row(GROUP, "peak resident memory, children included", "MB", RIVAL, *memory),
    )
    return Result(rows, {"starts": [[asdict(start) for start in turn] for turn in turns]})


def _compile() -> None:
    """Compile this package as pip compiles what it installs, the rival's packages too; it may lie here as sources."""
    if not compileall.compile_dir(Path(hgma_compensation.__file__).parent, quiet=1):
        raise RuntimeError("hgma_compensation cannot be compiled")


def _start(command: list[str], *, compensates: bool) -> Start:
    with imu_peer() as peer:
        begun = time.perf_counter()
        with started(command) as process:
            seconds = _first_answer(peer, changed=compensates) - begun
            _first_answer(peer, changed=compensates, after=AFTER)
            return Start(seconds, peak_megabytes(process.pid))


def _first_answer(peer: Peer, *, changed: bool, after: float = 0.0) -> float:
    """Stream until a message comes back later than ``after`` s from now; return when, on the clock of perf_counter.

    changed: what comes back as it was sent is no answer: a node without a temperature leaves it as it is.
    """
    stream = ImuStream(RATE, time.time_ns())
    heard: list[bytes] = []
    answered: list[float] = []
    begun = time.perf_counter()

    def send(number: int) -> None:
        if number % round(RATE / THERMISTOR_RATE) == 0:
            peer.send_temperature(stream.stamp(number))
        peer.send(stream.message(number))

    def take() -> None:
        peer.take(heard)
        now = time.perf_counter()
        if heard and now - begun >= after and (not changed or stream.received(heard).changed):
            answered.append(now)
        heard.clear()

    send_evenly(RATE, TIMEOUT, send, take, give_up=lambda _: bool(answered))
    if not answered:
        raise RuntimeError(f"no answer within {TIMEOUT:g} s")
    return answered[0]
