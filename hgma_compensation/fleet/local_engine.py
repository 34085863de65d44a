"""Jobs on the cores of this machine, which go on when a worker dies."""

import multiprocessing
import os
import signal
from collections import deque
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager

from hgma_compensation.fleet.job import failed, run_job
from hgma_compensation.fleet.options import Job
from hgma_compensation.fleet.status import Status

KILLED = (
    "its worker was killed twice, the second time with nothing beside it (out of memory?): calibrate it by itself with "
    "hgma train, on a machine that has more memory"
)

Work = Callable[[Job], Status]


def run_here(jobs: Sequence[Job], workers: int, work: Work = run_job) -> Iterator[Status]:
    """Yield what became of each job, in the order in which they end.

    Jobs that were running when a worker died are run again, one at a time: the one that kills its worker then is the
    one to blame, and is reported as such. work: what a worker does, found by its name when it starts.
    """
    waiting = deque(jobs)
    while waiting:
        suspects = yield from _run_until_a_worker_dies(waiting, workers, work)
        for job in suspects:
            guilty = yield from _run_until_a_worker_dies(deque([job]), 1, work)
            if guilty:
                yield failed(job, KILLED)


def _run_until_a_worker_dies(waiting: deque[Job], workers: int, work: Work) -> Generator[Status, None, list[Job]]:
    """Yield results until nothing waits; return the jobs that were running when a worker died."""
    with _pool(workers) as pool:
        running: dict[Future[Status], Job] = {}
        while waiting or running:
            # No more at a time than there are workers: what runs when one dies is then known.
            while waiting and len(running) < workers:
                job = waiting.popleft()
                try:
                    running[pool.submit(work, job)] = job
                except BrokenProcessPool:
                    return [job, *running.values()]
            broken = False
            for future in wait(running, return_when=FIRST_COMPLETED).done:
                try:
                    status = future.result()
                except BrokenProcessPool:
                    broken = True
                    continue
                del running[future]
                yield status
            if broken:
                return list(running.values())
    return []


@contextmanager
def _pool(workers: int) -> Iterator[ProcessPoolExecutor]:
    """Give a pool whose processes end at once where the block is left by an exception, such as Ctrl-C."""
    others = set(multiprocessing.active_children())
    # Not forked from this process, whatever that has loaded and started: from one that has loaded what a job needs,
    # once for all pools that there are to be.
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["hgma_compensation.fleet.job"])
    pool = ProcessPoolExecutor(workers, mp_context=context, initializer=_begin)
    try:
        yield pool
        pool.shutdown()
    except BaseException:
        for process in set(multiprocessing.active_children()) - others:
            process.terminate()
        pool.shutdown(wait=False, cancel_futures=True)
        raise


def _begin() -> None:
    """Leave Ctrl-C to the main process, which says once what was done."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def cores() -> int:
    """Return the number of cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
