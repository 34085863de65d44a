"""Threads of the linear algebra underneath numpy and scipy."""

from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module


@contextmanager
def one_thread() -> Iterator[None]:
    """Keep linear algebra to one thread meanwhile, where threadpoolctl is installed; may be used as a decorator.

    The matrices of training and diagnosis have some hundred rows: threads wait for each other longer than they work,
    ten times as long where another process wants a core. And sums are split by the number of threads, so results would
    depend on it in their last bits.
    """
    try:
        limits = import_module("threadpoolctl").threadpool_limits
    except ModuleNotFoundError:
        yield
        return
    with limits(limits=1, user_api="blas"):
        yield
