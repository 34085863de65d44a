"""Calibrates a simulated fleet on a Dask cluster of two processes, one of which is killed, and on this machine.

Compares the two byte for byte, and prints what was found. Exit code 1 where a sensor was lost, or a byte differs.
Run: make fleet-benchmark. With --simulate-only DIR it only writes the fleet, to try `hgma fleet` with.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from benchmarks.dask_processes import Cluster, local_cluster
from benchmarks.simulated_fleet import write_fleet

LIMITS = Path(__file__).resolve().parents[1] / "params" / "acceptance.yaml"
KILLED_AFTER = 0.25
"""Share of the sensors that are finished when a worker is killed."""

LOOK = 0.1
"""s from one look at what is finished to the next."""


@dataclass(frozen=True)
class Kill:
    """finished: sensors when the worker was killed. begun: sensors that were being calibrated then."""

    finished: int
    begun: tuple[str, ...]


@dataclass(frozen=True)
class Outcome:
    """What a benchmark found. lost: sensors without a state in the cluster's summary. differing: files."""

    sensors: int
    damaged: tuple[str, ...]
    kill: Kill | None
    seconds_cluster: float
    seconds_here: float
    lost: tuple[str, ...]
    files: int
    differing: tuple[str, ...]
    counts: dict[str, int]
    accepted_share: float
    failed: tuple[str, ...]
    worst: tuple[str, ...]

    @property
    def good(self) -> bool:
        """Whether nothing was lost, nothing differs, and only damaged recordings failed."""
        return not self.lost and not self.differing and set(self.failed) == set(self.damaged)


def hgma_fleet(sensors: Path, output: Path, *more: str) -> float:
    """Run the command and return the seconds that it took; raises RuntimeError where it was refused."""
    command = [sys.executable, "-m", "hgma_compensation.cli.main", "fleet", str(sensors), "-o", str(output)]
    begun = time.monotonic()
    done = subprocess.run([*command, "--limits", str(LIMITS), *more], capture_output=True, text=True)
    if done.returncode not in (0, 1):
        raise RuntimeError(f"hgma fleet ended with {done.returncode}: {done.stderr}")
    return time.monotonic() - begun


def kill_one(cluster: Cluster, output: Path, sensors: int, killed: list[Kill], ended: threading.Event) -> None:
    """Kill the first worker (SIGKILL) when KILLED_AFTER of the sensors are finished and others have begun."""
    while not ended.wait(LOOK):
        folders = [path for path in output.glob("*") if path.is_dir()]
        begun = tuple(sorted(path.name for path in folders if not (path / "status.json").exists()))
        finished = len(folders) - len(begun)
        if finished >= KILLED_AFTER * sensors and len(begun) >= len(cluster.workers):
            cluster.workers[0].kill()
            killed.append(Kill(finished, begun))
            return


def on_cluster(
    sensors: Path, output: Path, scratch: Path, count: int, kill: bool, *more: str
) -> tuple[float, Kill | None]:
    """Calibrate on two worker processes; return the seconds, and when one was killed."""
    killed: list[Kill] = []
    ended = threading.Event()
    with local_cluster(scratch, 2) as cluster:
        killer = threading.Thread(target=kill_one, args=(cluster, output, count, killed, ended))
        if kill:
            killer.start()
        try:
            seconds = hgma_fleet(sensors, output, "--scheduler", cluster.address, *more)
        finally:
            ended.set()
            if kill:
                killer.join()
    return seconds, killed[0] if killed else None


def contents(folder: Path) -> dict[str, bytes]:
    """Return every file in a folder by its path from there."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


def measure(folder: Path, count: int, seed: int, kill: bool, generations: int) -> Outcome:
    """Simulate a fleet in a folder, calibrate it twice, and compare."""
    sensors = folder / "sensors"
    damaged = write_fleet(sensors, count, seed)
    more = ("--generations", str(generations))
    scratch = folder / "cluster"
    scratch.mkdir()
    seconds, killed = on_cluster(sensors, folder / "on_cluster", scratch, count, kill, *more)
    seconds_here = hgma_fleet(sensors, folder / "here", *more)
    if kill and killed is None:
        raise RuntimeError("the fleet ended before a worker could be killed: take more --sensors")
    theirs, ours = contents(folder / "on_cluster"), contents(folder / "here")
    summary = json.loads(theirs["summary.json"])
    states = {name: sensor["state"] for name, sensor in summary["sensors"].items()}
    names = {path.name for path in sensors.iterdir()}
    return Outcome(
        sensors=count,
        damaged=damaged,
        kill=killed,
        seconds_cluster=seconds,
        seconds_here=seconds_here,
        lost=tuple(sorted(names - set(states))),
        files=len(ours),
        differing=tuple(sorted(n for n in theirs.keys() | ours.keys() if theirs.get(n) != ours.get(n))),
        counts=summary["counts"],
        accepted_share=summary["yield"],
        failed=tuple(sorted(name for name, state in states.items() if state == "failed")),
        worst=tuple(summary["worst"][:5]),
    )


def report(outcome: Outcome) -> str:
    """Return the outcome as a table of Markdown."""
    counts, kill = outcome.counts, outcome.kill
    when = "none" if kill is None else f"after {kill.finished} sensors, in the middle of {' and '.join(kill.begun)}"
    rows = [
        ("sensors", f"{outcome.sensors}, {len(outcome.damaged)} of them with a damaged recording"),
        ("worker killed (SIGKILL)", when),
        ("lost", str(len(outcome.lost))),
        ("not calibrated", ", ".join(outcome.failed) or "none"),
        ("accepted, rejected", f"{counts['accepted']}, {counts['rejected']}"),
        ("yield", f"{100.0 * outcome.accepted_share:.1f} %"),
        ("worst", ", ".join(outcome.worst)),
        ("files that differ from the run on one machine", f"{len(outcome.differing)} of {outcome.files}"),
        ("time on the cluster, one worker killed", f"{outcome.seconds_cluster:.0f} s"),
        ("time on this machine, a process for each core", f"{outcome.seconds_here:.0f} s"),
    ]
    return "\n".join(["| | |", "| --- | --- |", *(f"| {name} | {value} |" for name, value in rows)])


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table; with --json also write it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sensors", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1, help="of the simulation")
    parser.add_argument("--kill-one", action="store_true", help="kill one of the two workers on the way")
    parser.add_argument("--generations", type=int, default=20, help="of the genetic search, 200 by default elsewhere")
    parser.add_argument("--simulate-only", type=Path, metavar="DIR", help="only write the fleet there")
    parser.add_argument("--keep", type=Path, metavar="DIR", help="new folder for recordings and results")
    parser.add_argument("--json", type=Path, help="file for the figures")
    chosen = parser.parse_args(arguments)
    if chosen.simulate_only is not None:
        write_fleet(chosen.simulate_only, chosen.sensors, chosen.seed)
        return 0
    with tempfile.TemporaryDirectory() as scratch:
        folder = chosen.keep or Path(scratch)
        folder.mkdir(exist_ok=True)
        outcome = measure(folder, chosen.sensors, chosen.seed, chosen.kill_one, chosen.generations)
    print(report(outcome))
    for name in (*outcome.lost, *outcome.differing):
        print(f"lost or different: {name}", file=sys.stderr)
    if chosen.json:
        chosen.json.write_text(json.dumps(asdict(outcome), indent=1) + "\n", encoding="utf-8")
    return 0 if outcome.good else 1


if __name__ == "__main__":
    sys.exit(main())
