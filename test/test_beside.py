import gc
import threading

import pytest

from hgma_compensation.errors import RefusedError
from hgma_compensation.node.beside import run_beside


def test_what_cannot_wait_is_served_until_the_job_is_done():
    served, enough = [], threading.Event()

    def serve():
        served.append(threading.get_ident())
        if len(served) == 5:
            enough.set()

    assert run_beside(lambda: enough.wait(20.0) and threading.get_ident(), serve) not in {None, *served}
    assert set(served) == {threading.get_ident()}


def test_what_the_job_raises_is_raised_here():
    def refuse():
        raise RefusedError("no such file")

    with pytest.raises(RefusedError, match="no such file"):
        run_beside(refuse, lambda: None)


def test_a_job_that_does_not_end_is_given_up_and_the_next_one_runs():
    never = threading.Event()
    with pytest.raises(TimeoutError, match=r"not done within 0\.05 s"):
        run_beside(never.wait, lambda: None, patience=0.05)
    assert run_beside(lambda: 7, lambda: None) == 7
    never.set()


@pytest.mark.parametrize("raises", [False, True])
def test_garbage_is_collected_after_a_job_as_before_it(raises):
    def serve():
        assert not gc.isenabled()
        if raises:
            raise KeyError

    ready = threading.Event()
    try:
        run_beside(lambda: ready.wait(0.05), serve)
    except KeyError:
        assert raises
    assert gc.isenabled()
