import os
import subprocess
import sys

import pytest
import threadpoolctl

from hgma_compensation.training import linear_algebra
from hgma_compensation.training.linear_algebra import one_thread

# In a process of its own: the number of threads is read from the environment when the library is loaded.
COUNT = """
import numpy, scipy.linalg, threadpoolctl
from hgma_compensation.training.linear_algebra import one_thread

def threads():
    return max(i["num_threads"] for i in threadpoolctl.threadpool_info() if i["user_api"] == "blas")

@one_thread()
def called():
    return threads()

before = threads()
print(before, called(), called(), threads())
"""


def test_one_thread_inside_and_as_many_as_before_outside():
    environment = {**os.environ, **dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "2")}
    done = subprocess.run([sys.executable, "-c", COUNT], env=environment, capture_output=True, text=True, check=True)
    before, *inside, after = done.stdout.split()
    assert inside == ["1", "1"]
    assert before == after == str(min(2, os.cpu_count() or 1))


def test_without_threadpoolctl_nothing_is_limited_and_nothing_fails(monkeypatch):
    def missing(name):
        raise ModuleNotFoundError(name)

    monkeypatch.setattr(linear_algebra, "import_module", missing)
    with one_thread():
        pass


def test_an_error_inside_is_passed_on_and_the_threads_are_given_back():
    threads = [one["num_threads"] for one in threadpoolctl.threadpool_info()]
    with pytest.raises(ValueError, match="inside"), one_thread():
        raise ValueError("inside")
    assert [one["num_threads"] for one in threadpoolctl.threadpool_info()] == threads
