"""An hour of stream with every fault put in at random, through the real node over DDS: ``make soak``.

Prints one line of JSON; exit code 1 where a number that is not finite came out, a sample is unaccounted for, a fault
went unsaid, or the node's memory grew.
"""

import argparse
import json
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.soak.faults.calibrations import write_calibrations
from benchmarks.soak.faults.kinds import FAULTS
from benchmarks.soak.faults.peer import Peer
from benchmarks.soak.faults.segment import Block, Sample
from benchmarks.soak.faults.stream import CLOCKS, Stream
from benchmarks.soak.reliable_inputs import RELIABLE
from benchmarks.soak.resident import resident_kilobytes
from hgma_compensation.demo.processes import private_ros_environment, running

WARM_UP = 0.25
"""Fraction of the run after which memory must not grow."""

MOST_GROWTH = 1024.0
"""kB."""

SETTLED_EVERY = 50
"""Segments after which the account is checked, so that the node's queue never overflows unseen."""


def main() -> int:
    """Run the soak."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=3600.0, help="of the stream")
    parser.add_argument("--rate", type=float, default=50.0, help="Hz of the stream's messages")
    parser.add_argument("--speed", type=float, default=400.0, help="messages of the accelerometer per second of run")
    parser.add_argument("--seed", type=int, default=5)
    options = parser.parse_args()
    environment = private_ros_environment()
    with tempfile.TemporaryDirectory() as folder:
        good, refused = write_calibrations(Path(folder))
        parameters = [f"calibration_file:={good[0]}", "state_rate:=0.0", *RELIABLE]
        words = [word for parameter in parameters for word in ("-p", parameter)]
        command = [sys.executable, "-m", "hgma_compensation.node.main", "--ros-args", *words]
        with running(command, environment, "using calibration") as process:
            peer = Peer(int(environment["ROS_DOMAIN_ID"]), good, refused)
            figures = _run(peer, process.pid, options)
            peer.close()
    print(json.dumps(figures))
    return 0 if not figures["broken"] else 1


def _run(peer: Peer, pid: int, options: argparse.Namespace) -> dict[str, Any]:
    stream = Stream(np.random.default_rng(options.seed), options.rate)
    peer.connect()
    segments = list(stream.segments(options.seconds))
    resident, unsettled, begin = [], 0, time.monotonic()
    for number, segment in enumerate(segments):
        _send(peer, segment, options.speed)
        if number % SETTLED_EVERY == 0:
            unsettled += not peer.settle()
        resident.append(resident_kilobytes(pid))
        if sys.stderr.isatty():
            print(f"\r{number + 1} of {len(segments)} segments", end="", file=sys.stderr)
    unsettled += not peer.settle()
    return _figures(peer, stream, resident, unsettled, time.monotonic() - begin)


def _send(peer: Peer, segment: list[Any], speed: float) -> None:
    """Send a segment at an even rate of its accelerometer messages."""
    begin, count = time.monotonic(), 0
    for item in segment:
        peer.send(item)
        if isinstance(item, (Sample, Block)):
            count += 1
            peer.spin(max(begin + count / speed - time.monotonic(), 0.0) if count % 10 == 0 else 0.0)


def _figures(peer: Peer, stream: Stream, resident: list[float], unsettled: int, seconds: float) -> dict[str, Any]:
    said = peer.diagnostics
    received, compensated, skipped = (int(said[f"samples_{n}"]) for n in ("received", "compensated", "skipped"))
    counters = {**{name: fault.counters for name, fault in FAULTS.items()}, **CLOCKS}
    unsaid = [n for n in stream.faults if counters[n] and not any(int(said.get(c, "0")) for c in counters[n])]
    tenth = max(len(resident) // 10, 1)
    warm = resident[int(WARM_UP * len(resident)) :][:tenth]
    growth = float(np.median(resident[-tenth:]) - np.median(warm))
    broken = dict(peer.wrong)
    broken |= {"unaccounted": abs(peer.sent - compensated - skipped) + abs(received - peer.sent)}
    broken |= {"outputs_missing": abs(compensated - peer.outputs), "unsettled": unsettled}
    broken |= {"faults_unsaid": len(unsaid), "memory_grew": int(growth > MOST_GROWTH)}
    return {
        "broken": {name: count for name, count in broken.items() if count},
        "samples_sent": peer.sent,
        "samples_compensated": compensated,
        "samples_skipped": skipped,
        "states": peer.states,
        "faults": sum(stream.faults.values()),
        "kinds_of_faults": len(stream.faults),
        "unsaid": unsaid,
        "memory_growth_kB": round(growth),
        "memory_kB": round(resident[-1]),
        "seconds": round(seconds),
    }


if __name__ == "__main__":
    sys.exit(main())
