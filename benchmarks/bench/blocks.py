"""Blocks of 10 000 samples of three axes: the node against a plain relay of the same blocks."""

import time
from dataclasses import asdict
from subprocess import Popen

from benchmarks.bench.block_stream import SAMPLES, BlockStream, BlockTrial, blocks_through
from benchmarks.bench.given import Given
from benchmarks.bench.peer import Peer
from benchmarks.bench.processes import node_command, relay_command, started
from benchmarks.bench.row import Result, Row, Target
from benchmarks.bench.trials import TIMEOUT, tell_past
from hgma_compensation import topics
from hgma_compensation.node.interfaces import input_qos
from hgma_msgs.msg import AccelBlock

GROUP, RIVAL = "blocks", "plain relay"
SECONDS, WARM_UP, SETTLING = 5.0, 1.0, 25.0
"""s; the last one until the gain of a filter has settled, many of its time constants in time of the sensor."""
ASKED = 10e6
"""Samples of three axes a second."""

RELIABLE = f"qos_overrides./{topics.RAW_BLOCK}.subscription.reliability:=reliable"
"""For the node as for the relay: a window in flight asks for an answer to every block."""

SMOOTH = "filter smooth"
SIDES = ("no filter", SMOOTH, "three effects", RIVAL)


def measure(given: Given) -> Result:
    """Return the rows of the block path."""
    files = (given.calibrations.plain(), given.calibrations.smooth(), given.calibrations.with_effects())
    commands = [node_command(file, RELIABLE) for file in files]
    commands.append(relay_command("block", input_qos(topics.RAW_BLOCK).depth, "reliable"))
    trials: dict[str, list[BlockTrial]] = {name: [] for name in SIDES}
    for repetition in range(given.repetitions):
        for name, command in zip(SIDES, commands, strict=True):
            trial = _trial(command, changes=name != RIVAL, warm_up=SETTLING if name == SMOOTH else WARM_UP)
            trials[name].append(trial)
            turn = f"{repetition + 1}/{given.repetitions}"
            given.say(f"blocks {turn} {name}: {trial.rate:.1f}/s, {1e3 * trial.cpu:.2f} ms CPU each")
    rates = {name: tuple(trial.rate for trial in trials[name]) for name in SIDES}
    lost = {name: sum(trial.lost for trial in trials[name]) for name in SIDES}
    rows = [
        Row(
            GROUP,
            f"10 000 samples, {name}",
            "blocks/s",
            RIVAL,
            rates[name],
            rates[RIVAL],
            Target(0.7, at_least=True) if name == SIDES[0] else None,
            f"{lost[name]} lost" if lost[name] else "",
        )
        for name in SIDES[:-1]
    ]
    million = tuple(rate * SAMPLES * 1e-6 for rate in rates[SIDES[0]])
    asked = (ASKED * 1e-6,) * given.repetitions
    target = Target(1.0, at_least=True)
    rows.insert(1, Row(GROUP, "samples through the node", "million/s", "what is asked", million, asked, target))
    cpu = {name: tuple(1e3 * trial.cpu for trial in trials[name]) for name in SIDES}
    rows.append(Row(GROUP, "CPU per block, no filter", "ms", RIVAL, cpu[SIDES[0]], cpu[RIVAL]))
    return Result(tuple(rows), {name: [asdict(trial) for trial in trials[name]] for name in SIDES})


def _trial(command: list[str], *, changes: bool, warm_up: float) -> BlockTrial:
    with started(command) as process:
        peer = Peer(AccelBlock, topics.RAW_BLOCK, topics.COMPENSATED_BLOCK)
        try:
            stream = BlockStream()
            _await_answer(peer, process, stream)
            tell_past(peer, stream.message()[0])
            blocks_through(peer, process.pid, stream, warm_up)
            trial = blocks_through(peer, process.pid, stream, SECONDS)
        finally:
            peer.close()
    if trial.changed is not changes:
        raise RuntimeError(f"blocks came back {'changed' if trial.changed else 'unchanged'}: {' '.join(command)}")
    return trial


def _await_answer(peer: Peer, process: Popen[bytes], stream: BlockStream) -> None:
    """Send a block now and then until one comes back; raises RuntimeError where none does."""
    heard: list[bytes] = []
    end = time.monotonic() + TIMEOUT
    while not heard:
        if process.poll() is not None or time.monotonic() > end:
            raise RuntimeError(f"process {process.args!r} does not answer (exit code {process.returncode})")
        if peer.found():
            peer.send(stream.message()[1])
        peer.wait(0.2)
        peer.take(heard)
    peer.forget()
