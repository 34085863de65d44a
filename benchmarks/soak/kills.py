"""The node killed and started again while it streams: ``python -m benchmarks.soak.kills --count 100``.

Each life of the node must take up the memory of the one before, and its drift must go on where an uninterrupted
compensation in this process is; beside it stands what a node without a past would have made of the same samples.
"""

import argparse
import json
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Mapping
from pathlib import Path
from statistics import median
from typing import Any

from benchmarks.soak.driver import Driver
from benchmarks.soak.killed_writers import kill_writers
from benchmarks.soak.remembering import Truth, remembering_calibration
from hgma_compensation.calibration.document import write_calibration
from hgma_compensation.demo.processes import private_ros_environment
from hgma_compensation.pipeline.state_file import read_state, remove_litter
from hgma_compensation.pipeline.taking_up import Past

PATIENCE = 30.0
"""s to wait for a node to answer."""

LARGEST_ERROR = 0.05
"""Of what would be lost without the memory: a life may begin up to the outage and a period behind."""

LIFE = 1.0
"""s after which a node is killed at the latest, once it has taken up the memory."""


class Lives:
    """The lives of one node, and what they showed."""

    def __init__(self, folder: Path, environment: Mapping[str, str], driver: Driver, truth: Truth) -> None:
        """Keep calibration and state in a folder."""
        self._folder, self._environment, self._driver, self._truth = folder, environment, driver, truth
        self.state = folder / "state.json"
        write_calibration(truth.calibration, folder / "calibration.json")
        self.errors: list[float] = []
        self.lost: list[float] = []
        self.outages: list[float] = []
        self.interrupted = 0

    def start(self) -> subprocess.Popen[bytes]:
        """Start the node."""
        words = [f"calibration_file:={self._folder / 'calibration.json'}", f"state_file:={self.state}"]
        command = [sys.executable, "-m", "hgma_compensation.node.main", "--ros-args"]
        command += [
            word for parameter in [*words, "state_period:=1.0", "state_rate:=0.0"] for word in ("-p", parameter)
        ]
        return subprocess.Popen(
            command, env=dict(self._environment), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )

    def first(self) -> subprocess.Popen[bytes]:
        """Give the first node its past, and wait until that is saved."""
        node = self.start()
        self._until(self._driver.hears_a_node, 0.0)
        time.sleep(1.0)
        self._driver.send_past()
        self._driver.begin()
        self._until(lambda: (s := read_state(self.state)) is not None and (s.acceleration or 0) > self._driver.start)
        return node

    def kill(self, node: subprocess.Popen[bytes]) -> None:
        """Kill a node, and look at its file."""
        node.send_signal(signal.SIGKILL)
        node.wait()
        self._killed_at = time.monotonic()
        self._driver.forget_replies()
        self._truth.forget()
        if read_state(self.state) is None:
            raise AssertionError("the state file is gone")
        litter = f".{self.state.name}."
        self.interrupted += any(entry.name.startswith(litter) for entry in self._folder.iterdir())

    def restart(self) -> tuple[subprocess.Popen[bytes], str]:
        """Start the node again, and return it with what it says of its memory."""
        node = self.start()
        self._until(lambda: bool(self._driver.drift))
        self.outages.append(self._driver.first_state - self._killed_at)
        self._until(lambda: self._memory_said() not in ("", Past.WAITING.value))
        return node, self._memory_said()

    def _memory_said(self) -> str:
        return self._driver.diagnostics[-1]["memory"] if self._driver.diagnostics else ""

    def compare(self) -> None:
        """Compare the drift of this life with that without an interruption."""
        stamps = [stamp for stamp in self._driver.drift if stamp in self._truth.drift]
        self.errors.append(max(abs(self._driver.drift[s] - self._truth.drift[s]) for s in stamps))
        self.lost.append(min(abs(self._truth.forgotten[s] - self._truth.drift[s]) for s in stamps))

    def _until(self, condition: Callable[[], bool], step: float = 0.05) -> None:
        end = time.monotonic() + PATIENCE
        while not condition():
            if time.monotonic() > end:
                raise AssertionError("the node does not answer")
            self._driver.drive(step) if step else time.sleep(0.05)


def soak(kills: int, writers: int, seed: int, folder: Path) -> dict[str, Any]:
    """Return the figures of a run; raises RefusedError where a file does not load, AssertionError without answers."""
    moments, truth = random.Random(seed), Truth(remembering_calibration())
    truth.add_temperature(1, 20.0)
    truth.compensate(1, 9.81)
    figures: dict[str, Any] = dict(kill_writers(truth.live, folder / "written.json", writers, seed))
    truth = Truth(truth.calibration)
    environment = private_ros_environment()
    driver = Driver(int(environment["ROS_DOMAIN_ID"]), truth)
    lives = Lives(folder, environment, driver, truth)
    said: list[str] = []
    node = lives.first()
    try:
        for number in range(kills):
            driver.drive(moments.uniform(0.0, LIFE))
            lives.kill(node)
            node, memory = lives.restart()
            said.append(memory)
            lives.compare()
            if sys.stderr.isatty() or number % 10 == 9:
                print(f"{number + 1} kills", file=sys.stderr)
    finally:
        node.kill()
        node.wait()
        driver.close()
    return {**figures, **_figures(lives, said)}


def _figures(lives: Lives, said: list[str]) -> dict[str, Any]:
    return {
        "kills": len(said),
        "taken_up": said.count(Past.TAKEN_UP.value),
        "said": dict(Counter(said)),
        "killed_while_saving": lives.interrupted,
        "litter_left": remove_litter(lives.state),
        "state_bytes": lives.state.stat().st_size,
        "outage_s": {"median": round(median(lives.outages), 2), "longest": round(max(lives.outages), 2)},
        "largest_error": round(max(lives.errors), 4),
        "median_error": round(median(lives.errors), 4),
        "least_lost_without_memory": round(min(lives.lost), 2),
    }


def main() -> int:
    """Run, print the figures as one line of JSON, and return 1 where a bound is broken."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=100, help="kills of the node")
    parser.add_argument("--writers", type=int, default=400, help="kills of a process that only writes the file")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        figures = soak(options.count, options.writers, options.seed, Path(folder))
    bound = LARGEST_ERROR * figures["least_lost_without_memory"]
    figures["passed"] = figures["taken_up"] == figures["kills"] and figures["largest_error"] <= bound
    print(json.dumps(figures))
    return 0 if figures["passed"] else 1


if __name__ == "__main__":
    sys.exit(main())
