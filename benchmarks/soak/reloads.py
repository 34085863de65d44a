"""Loads calibrations again and again under a stream at 1 kHz, and checks every sample: ``make soak``.

Two calibrations subtract constants, so that what each sample must have become is known exactly. They are loaded in
turn, by service and by parameter in turn, and now and then a file that is refused. Exit code 1 where a sample was
lost, or belongs to another calibration than its state says, or a request got the wrong answer.
"""

import argparse
import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.soak.latency import latency_figures
from benchmarks.soak.outputs import Outputs
from benchmarks.soak.reload_account import Recorded, Request, faults_of
from benchmarks.soak.reload_client import ReloadClient
from benchmarks.soak.reload_files import write_calibrations, write_refused
from benchmarks.soak.resident import children_of, processor_seconds, resident_kilobytes
from hgma_compensation.cli.progress_bars import counting_bar
from hgma_compensation.demo.processes import private_ros_environment, running

NODE = (sys.executable, "-m", "hgma_compensation.node.main", "--ros-args")
SOURCE = (sys.executable, "-m", "benchmarks.soak.imu_source")
RELIABLE = (
    "qos_overrides./accel/raw.subscription.reliability:=reliable",
    "qos_overrides./accel/raw.subscription.depth:=10000",
)
EVERY = 10
"""Requests of which one is refused."""
KEPT_UP = 0.02
"""s that the newest output may be old before the next request; a busy machine is given time to catch up."""
GIVEN_TIME = 1.0
"""s, at most, that it is given."""
LAST_OUTPUTS = 5.0
"""s that the last outputs may take."""


def main() -> int:
    """Run the soak and print its figures as one line of JSON."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0] if __doc__ else "")
    parser.add_argument("--count", type=int, default=10_000, help="calibrations to load")
    parser.add_argument("--rate", type=float, default=1000.0, help="Hz")
    parser.add_argument("--period", type=float, default=0.025, help="s from one request to the next, at least")
    parser.add_argument("--quiet", type=float, default=5.0, help="s of stream before the first request, to compare")
    parser.add_argument("--history", type=int, default=0, help="thermistor samples that the node remembers")
    parser.add_argument("--centres", type=int, default=0, help="of each network; 0: polynomials")
    parser.add_argument("--channels", type=int, default=1, help="calibrated channels")
    parser.add_argument("--reliable", action="store_true", help="let the node subscribe reliably, with a queue of 10 s")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as directory:
        figures = soak(options, Path(directory))
    print(json.dumps(figures))
    return 1 if any(figures["faults"].values()) else 0


def soak(options: argparse.Namespace, directory: Path) -> dict[str, Any]:
    """Return the figures of a run; options: those of the command."""
    calibrations = write_calibrations(directory, 2, options.centres, options.channels)
    paths = list(calibrations)
    refused = write_refused(directory, paths[0].read_bytes())
    environment = private_ros_environment()
    parameters = [f"calibration_file:={paths[0]}", "state_rate:=0.0", *(RELIABLE if options.reliable else [])]
    command = [*NODE, *(word for parameter in parameters for word in ("-p", parameter))]
    with running(command, environment, "using calibration") as node:
        client = ReloadClient(int(environment["ROS_DOMAIN_ID"]))
        outputs = Outputs(
            client.listener,
            [calibration.calibration_id for calibration in calibrations.values()],
            next(iter(calibrations.values())).names,
        )
        client.wait_for_outputs()
        with _source(environment, options) as stop:
            _quiet(outputs, 0.0)
            ran, started = processor_seconds(node.pid), time.monotonic()
            _quiet(outputs, options.quiet)
            busy = (processor_seconds(node.pid) - ran) / (time.monotonic() - started)
            started = time.monotonic()
            requests, wrong = _reload(client, outputs, paths, refused, options)
            elapsed = time.monotonic() - started
            memory = [resident_kilobytes(pid) for pid in (node.pid, *children_of(node.pid))]
            sent = stop(outputs)
        received = client.received_by_node()
        client.close()
    recorded = outputs.recorded
    return {
        "loaded": options.count,
        "refused": len(requests) - options.count,
        "loads_per_second": round(options.count / elapsed, 1),
        "reliable": options.reliable,
        "file_bytes": paths[0].stat().st_size,
        "thermistor_history": options.history,
        "node_cores_quiet": round(busy, 2),
        "node_and_loading_process_kb": memory,
        "answer_ms_median": round(float(np.median([r.answered - r.sent for r in requests])) * 1e-6, 2),
        **sent,
        "outputs": len(recorded.x),
        **latency_figures(recorded.stamp, recorded.published, *_phases(recorded, requests)),
        "faults": {
            **faults_of(recorded, sent["sent"], [1.0, 2.0], requests),
            "lost_before_the_node": sent["sent"] - received,
            "wrong_answers": wrong,
        },
    }


@contextmanager
def _source(environment: dict[str, str], options: argparse.Namespace) -> Iterator[Any]:
    """Run the source; gives the function that stops it, waits for all outputs, and returns what it says of itself."""
    command = [*SOURCE, "--rate", str(options.rate), "--history", str(options.history)]
    process = subprocess.Popen(command, env=environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def stop(outputs: Outputs) -> dict[str, Any]:
        told: dict[str, Any] = json.loads(process.communicate()[0])
        end = time.monotonic() + LAST_OUTPUTS
        while min(len(outputs.recorded.x), len(outputs.recorded.calibration)) < told["sent"] and time.monotonic() < end:
            outputs.drain()
            time.sleep(0.01)
        return told

    try:
        yield stop
    finally:
        process.kill()
        process.wait()


def _quiet(outputs: Outputs, seconds: float) -> None:
    """Take outputs for a while, from the first one on."""
    while not outputs.recorded.x:
        outputs.drain()
        time.sleep(0.01)
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        outputs.drain()
        time.sleep(0.01)


def _reload(
    client: ReloadClient, outputs: Outputs, paths: list[Path], refused: list[Path], options: argparse.Namespace
) -> tuple[list[Request], int]:
    """Load ``count`` calibrations; return all requests, and how many got the wrong answer."""
    requests: list[Request] = []
    in_use = wrong = loaded = 0
    with counting_bar("loading calibrations", options.count) as advance:
        while loaded < options.count:
            number, sent = len(requests), time.time_ns()
            bad = number % EVERY == EVERY - 1
            path = refused[number // EVERY % len(refused)] if bad else paths[1 - in_use]
            accepted = client.load(path, by_parameter=number % 2 == 0, meanwhile=outputs.drain)
            wrong += accepted == bad
            if accepted:
                in_use, loaded = 1 - in_use, loaded + 1
                advance(1)
            requests.append(Request(sent, time.time_ns(), in_use))
            outputs.drain()
            time.sleep(max(sent * 1e-9 + options.period - time.time(), 0.0))
            _let_it_catch_up(outputs)
    return requests, wrong


def _let_it_catch_up(outputs: Outputs) -> None:
    end = time.time() + GIVEN_TIME
    outputs.drain()
    while outputs.recorded.stamp[-1] * 1e-9 < time.time() - KEPT_UP and time.time() < end:
        time.sleep(0.001)
        outputs.drain()


def _phases(recorded: Recorded, requests: list[Request]) -> tuple[Any, Any]:
    """Return which samples (n,) came while a request was answered, and which before the first one."""
    stamps = np.array(recorded.stamp)
    sent, answered = (np.array([getattr(request, name) for request in requests]) for name in ("sent", "answered"))
    last = np.searchsorted(sent, stamps, side="right") - 1
    return (last >= 0) & (stamps <= answered[np.maximum(last, 0)]), last < 0


if __name__ == "__main__":
    sys.exit(main())
