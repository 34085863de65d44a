"""A long job in a thread of its own, while the caller's thread goes on with what cannot wait."""

import gc
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from contextlib import contextmanager
from typing import TypeVar

TURN = 0.0005
"""s between two turns of what cannot wait: half a sample at 1 kHz."""

PATIENCE = 10.0
"""s after which a job is given up: a disk or network that does not answer cannot be interrupted."""

Result = TypeVar("Result")


def run_beside(job: Callable[[], Result], serve: Callable[[], None], patience: float = PATIENCE) -> Result:
    """Return the result of a job, or raise what it raised; ``serve`` is called in this thread until it is there.

    The job must not touch what ``serve`` touches. Raises TimeoutError after ``patience`` s; a job that ends later than
    that is forgotten.
    """
    result: Future[Result] = Future()
    ended = threading.Event()
    threading.Thread(target=_run, args=(job, result, ended), daemon=True).start()
    end = time.monotonic() + patience
    with _no_collection():
        while not ended.wait(TURN):
            if time.monotonic() > end:
                raise TimeoutError(f"not done within {patience:g} s")
            serve()
    return result.result()


@contextmanager
def _no_collection() -> Iterator[None]:
    """Keep the collector from going through all that the job has made, which stops every thread, while it makes it."""
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()


def _run(job: Callable[[], Result], result: Future[Result], ended: threading.Event) -> None:
    try:
        result.set_result(job())
    except BaseException as error:
        result.set_exception(error)
    finally:
        ended.set()
