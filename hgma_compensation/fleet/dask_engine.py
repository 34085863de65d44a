"""Jobs on the workers of a Dask cluster, which see the fleet's folders under the same paths.

A scheduler executes what its clients send it: see docs/FLEET.md on who may reach it.
"""

from __future__ import annotations

import logging
import os
import threading
import uuid
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hgma_compensation import __version__
from hgma_compensation.errors import RefusedError
from hgma_compensation.fleet.job import failed, run_job
from hgma_compensation.fleet.options import Job
from hgma_compensation.fleet.status import Status

if TYPE_CHECKING:
    from distributed import Client

PATIENCE = 10.0
"""s to reach the scheduler."""

RETRIES = 2
"""Times that a job is run again where it ended with an error of the cluster."""

SAME = ("numpy", "scipy", "pymoo", "filterpy")
"""Packages whose version may change the last bits of a calibration."""

KILLED = "the workers that it ran on died, {count} of them one after the other (out of memory?): {again}"
AGAIN = "give the same command again, or calibrate it by itself with hgma train"

_one_at_a_time = threading.Lock()


def run_on_cluster(jobs: Sequence[Job], address: str, work: Callable[[Job], Status] = run_job) -> Iterator[Status]:
    """Yield what became of each job, in the order in which they end.

    Jobs of a worker that dies are run elsewhere. work: what a worker does, found there by its name. Raises RefusedError
    where the cluster cannot be used, and where it is lost.
    """
    with _client(address) as client:
        check_workers(client, jobs[0].source, jobs[0].output)
        distributed = import_module("distributed")
        run = uuid.uuid4().hex
        futures = {
            client.submit(
                on_worker, job, __version__, work, key=f"hgma-fleet-{run}-{job.sensor}", pure=False, retries=RETRIES
            ): job
            for job in jobs
        }
        try:
            for future in distributed.as_completed(futures, loop=client.loop):
                yield _status(future, futures[future], address)
        except BaseException:
            client.cancel(list(futures))
            raise


def on_worker(job: Job, expected: str, work: Callable[[Job], Status] = run_job) -> Status:
    """Run a job on a worker, in a process that runs no other one: the number of threads is the process's own."""
    if expected != __version__:
        return failed(job, f"a worker has hgma_compensation {__version__}: install {expected} there")
    with _one_at_a_time:
        return work(job)


def _status(future: Any, job: Job, address: str) -> Status:
    distributed = import_module("distributed")
    try:
        status: Status = future.result()
    except distributed.scheduler.KilledWorker as error:
        return failed(job, KILLED.format(count=error.allowed_failures + 1, again=AGAIN))
    except distributed.CancelledError:
        raise RefusedError(
            f"--scheduler {address} was lost: start it again and give the same command, finished sensors are kept"
        ) from None
    except Exception as error:  # of the cluster: a job itself raises nothing
        return failed(job, str(RefusedError(f"the cluster failed on it ({error}): {AGAIN}")))
    return status


@contextmanager
def _client(address: str) -> Iterator[Client]:
    try:
        distributed = import_module("distributed")
    except ModuleNotFoundError:
        raise RefusedError("--scheduler needs Dask: pip install 'hgma_compensation[fleet]'") from None
    try:
        # A client of an address that is none waits at its end, and then complains of that.
        import_module("distributed.comm.addressing").get_address_host_port(address)
        client = distributed.Client(address, timeout=PATIENCE, set_as_default=False)
    except (OSError, ValueError, TypeError) as error:
        reason = " ".join(str(error).split()) or type(error).__name__
        raise RefusedError(
            f"--scheduler {address} does not answer ({reason}): start one with dask scheduler, and give its address "
            "as it prints it, such as tcp://10.0.0.1:8786"
        ) from None
    log = logging.getLogger("distributed.client")
    level = log.level
    log.setLevel(logging.CRITICAL)  # a connection that is lost is told in one line, not in the library's traceback
    try:
        with client:
            yield client
    finally:
        log.setLevel(level)


def check_workers(client: Client, source: Path, output: Path) -> None:
    """Raise RefusedError where there is no worker, or one has other software or does not see the fleet's folders."""
    marker = output / f".hgma-fleet-{uuid.uuid4().hex}"
    packages = client.get_versions(packages=["hgma_compensation"])["workers"]  # type: ignore[index]
    if not packages:
        raise RefusedError("the scheduler has no worker: start some with dask worker ADDRESS --nthreads 1")
    for worker, found in packages.items():
        theirs = found["packages"].get("hgma_compensation")
        if theirs != __version__:
            raise RefusedError(
                f"worker {worker} has hgma_compensation {theirs or '(not installed)'}, this machine {__version__}: "
                "install the same version there"
            )
    try:
        marker.touch()
        answers = client.run(look_around, str(source), str(marker), on_error="return")
    finally:
        marker.unlink(missing_ok=True)
    ours = look_around(str(source), "")
    for worker, answer in answers.items():
        if isinstance(answer, BaseException):
            raise RefusedError(f"worker {worker} cannot be asked what it sees ({answer}): look into its log")
        _check_answer(worker, answer, ours, source, output)


def _check_answer(worker: str, answer: dict[str, Any], ours: dict[str, Any], source: Path, output: Path) -> None:
    for package, version_here in ours["versions"].items():
        if answer["versions"][package] != version_here:
            raise RefusedError(
                f"worker {worker} has {package} {answer['versions'][package]}, this machine {version_here}: "
                "install the same version there, or calibrations may differ in their last digits"
            )
    shared = "put the fleet on a file system that all machines mount at the same path"
    if answer["sensors"] != ours["sensors"]:
        raise RefusedError(f"worker {worker} does not see what is in {source}: {shared}")
    if not answer["output"]:
        raise RefusedError(f"worker {worker} does not see {output}, or cannot write there: {shared}")


def look_around(source: str, marker: str) -> dict[str, Any]:
    """Return what a machine sees: entries of a folder, whether a file is there in a folder to write to, versions."""
    try:
        sensors = sorted(os.listdir(source))
    except OSError:
        sensors = []
    return {
        "sensors": sensors,
        "output": os.path.exists(marker) and os.access(os.path.dirname(marker), os.W_OK),
        "versions": {package: _version(package) for package in SAME},
    }


def _version(package: str) -> str | None:
    try:
        return version(package)
    except PackageNotFoundError:
        return None
