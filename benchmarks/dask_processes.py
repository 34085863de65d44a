"""A Dask cluster of processes on this machine, started as a person starts it, which may be killed one by one."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

STARTING = 60.0
"""s within which a scheduler writes its address."""


@dataclass(frozen=True)
class Cluster:
    """address: of the scheduler. workers: their processes; one that is killed stays dead, nobody starts it again."""

    address: str
    scheduler: subprocess.Popen[bytes]
    workers: tuple[subprocess.Popen[bytes], ...]


@contextmanager
def local_cluster(folder: Path, workers: int, environment: Mapping[str, str] | None = None) -> Iterator[Cluster]:
    """Run a scheduler and so many workers of one thread while the block runs; their logs go into the folder."""
    variables = {**os.environ, **(environment or {})}
    place = folder / "scheduler.json"
    local = ["--host", "127.0.0.1", "--no-dashboard"]
    started: list[subprocess.Popen[bytes]] = []

    def start(what: str, log: str, *words: str) -> subprocess.Popen[bytes]:
        command = [sys.executable, "-m", "dask", what, *local, *words]
        with open(folder / f"{log}.log", "wb") as file:
            started.append(subprocess.Popen(command, stdout=file, stderr=file, env=variables, cwd=folder))
        return started[-1]

    try:
        scheduler = start("scheduler", "scheduler", "--port", "0", "--scheduler-file", str(place))
        address = _address(place, scheduler)
        those = ("--nthreads", "1", "--no-nanny", "--local-directory", str(folder))
        processes = tuple(start("worker", f"worker-{number}", address, *those) for number in range(workers))
        yield Cluster(address, scheduler, processes)
    finally:
        for process in reversed(started):
            process.kill()
            process.wait()


def _address(place: Path, scheduler: subprocess.Popen[bytes]) -> str:
    until = time.monotonic() + STARTING
    while time.monotonic() < until and scheduler.poll() is None:
        try:
            return str(json.loads(place.read_text(encoding="utf-8"))["address"])
        except (FileNotFoundError, ValueError):  # not there, or not whole yet
            time.sleep(0.05)
    raise RuntimeError(f"the Dask scheduler did not start: see {place.with_name('scheduler.log')}")
