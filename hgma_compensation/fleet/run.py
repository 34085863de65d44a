"""A fleet calibrated: its sensors found, their jobs run, what became of them in the order of their names."""

from __future__ import annotations

import fcntl
import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing, contextmanager, suppress
from pathlib import Path

from hgma_compensation.errors import RefusedError
from hgma_compensation.fleet.local_engine import run_here
from hgma_compensation.fleet.options import FleetOptions, Job
from hgma_compensation.fleet.sensors import sensor_names
from hgma_compensation.fleet.status import CALIBRATION, EVALUATION, STATUS, Status

Engine = Callable[[Sequence[Job]], Iterator[Status]]
SUMMARY_JSON, SUMMARY_CSV, SUMMARY_PAGE = "summary.json", "summary.csv", "summary.html"


def jobs_of(source: Path, output: Path, options: FleetOptions) -> list[Job]:
    """Return a job for each sensor in a folder; raises RefusedError where it holds none, or the two folders collide."""
    names = sensor_names(source)
    source, output = source.resolve(), output.resolve()
    if output.is_relative_to(source):
        raise RefusedError(f"{output} lies in {source}, among the sensors: give a folder outside of it")
    for name in names:
        if source.is_relative_to(output / name):
            raise RefusedError(f"results of sensor {name} would go into {source}, the recordings: give another output")
    if output.exists() and not output.is_dir():
        raise RefusedError(f"{output} is a file: give the name of a folder")
    return [Job(source, output, name, options) for name in names]


def run_jobs(jobs: Sequence[Job], engine: Engine, progress: Callable[[Status], None] | None = None) -> list[Status]:
    """Return what became of each job, in the order of the jobs.

    engine: yields each in the order in which it ends, such as ``run_here``. Raises RefusedError where the output cannot
    be made, or another fleet is being written there.
    """
    output = jobs[0].output
    try:
        output.mkdir(exist_ok=True)
    except OSError as error:
        raise RefusedError(f"{output} cannot be made ({error.strerror}): create the folder above it first") from None
    ended: dict[str, Status] = {}
    with _alone(output):
        for job in jobs:
            _sweep(output / job.sensor)
        results = engine(jobs)
        with closing(results):  # type: ignore[type-var]
            for status in results:
                ended[status.sensor] = status
                if progress is not None:
                    progress(status)
    return [ended[job.sensor] for job in jobs]


def here(workers: int) -> Engine:
    """Return the engine of so many processes on this machine."""
    return lambda jobs: run_here(jobs, workers)


def on_cluster(address: str) -> Engine:
    """Return the engine of a Dask cluster."""
    from hgma_compensation.fleet.dask_engine import run_on_cluster

    return lambda jobs: run_on_cluster(jobs, address)


@contextmanager
def _alone(output: Path) -> Iterator[None]:
    """Hold the output while the block runs; raises RefusedError where somebody else does."""
    descriptor = os.open(output, os.O_RDONLY)
    try:
        with suppress(OSError):  # a file system without locks: nobody is kept out then
            try:
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                raise RefusedError(
                    f"another hgma fleet is writing to {output}: wait for it, or give another folder"
                ) from None
        yield
    finally:
        os.close(descriptor)


def _sweep(folder: Path) -> None:
    """Remove what was left of files that were being written when their writer was killed."""
    for name in (STATUS, CALIBRATION, EVALUATION):
        for left in folder.glob(f".{name}.*"):
            with suppress(OSError):
                left.unlink()
