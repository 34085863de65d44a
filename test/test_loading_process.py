import os
import signal
import subprocess
import sys
import time

import pytest
from builders import make_calibration
from children import children_of, wait_until_gone

from hgma_compensation.calibration.document import write_calibration
from hgma_compensation.loading import process as module
from hgma_compensation.loading.job import Request
from hgma_compensation.loading.process import LoadingProcess
from hgma_compensation.pipeline.live import LiveCompensation

PARENT = """
import sys, time
from hgma_compensation.loading.process import LoadingProcess
loading = LoadingProcess()
print("ready", flush=True)
time.sleep(60.0)
"""


_others = set()
"""Processes that other tests of this run have started and left."""


def children():
    """Return the numbers of the loading processes."""
    return [number for number in children_of(os.getpid()) if number not in _others]


def child():
    """Return the number of the only loading process."""
    (number,) = children()
    return number


def request(path):
    return Request(path, None, "", LiveCompensation().histories())


def nothing():
    """Serve nothing."""


@pytest.fixture(autouse=True)
def nobody_left():
    """Let a test that fails leave no stopped process behind: only being killed would end it."""
    _others.clear()
    _others.update(children_of(os.getpid()))
    yield
    for number in children():
        os.kill(number, signal.SIGKILL)


@pytest.fixture
def loading():
    made = LoadingProcess(patience=20.0)
    yield made
    made.close()
    assert not children()


def test_a_process_that_ended_while_nobody_asked_is_replaced(loading, calibration_file, calibration):
    for number in (signal.SIGKILL, signal.SIGTERM):
        first = child()
        os.kill(first, number)
        wait_until_gone(first)
        assert loading.ask(request(calibration_file), nothing).calibration.calibration_id == calibration.calibration_id
        assert child() != first


def test_a_process_that_is_killed_in_the_middle_is_replaced_and_asked_once_more(loading, calibration_file, calibration):
    first = child()
    os.kill(first, signal.SIGSTOP)

    def kill():
        if first in children():
            os.kill(first, signal.SIGKILL)

    pipeline = loading.ask(request(calibration_file), kill)
    assert pipeline.calibration.calibration_id == calibration.calibration_id


def test_a_request_that_ends_two_processes_is_given_up_and_the_next_one_is_answered(loading, calibration_file):
    def kill():
        for number in children():
            os.kill(number, signal.SIGKILL)

    os.kill(child(), signal.SIGSTOP)
    with pytest.raises(ChildProcessError, match="ended, twice"):
        loading.ask(request(calibration_file), kill)
    assert loading.ask(request(calibration_file), nothing)


def test_a_process_that_does_not_answer_is_given_up_while_the_stream_is_served(calibration_file, calibration):
    served, loading = [], LoadingProcess(patience=0.3)
    hanging = child()
    os.kill(hanging, signal.SIGSTOP)
    with pytest.raises(TimeoutError, match=r"not done within 0\.3 s"):
        loading.ask(request(calibration_file), lambda: served.append(time.monotonic()))
    assert len(served) > 20
    wait_until_gone(hanging)
    loading._patience = 20.0
    assert loading.ask(request(calibration_file), nothing).calibration.calibration_id == calibration.calibration_id
    loading.close()


def test_the_answer_to_a_request_that_failed_is_not_taken_for_that_to_the_next(loading, calibration_file, tmp_path):
    other = make_calibration(seed=5)
    write_calibration(other, tmp_path / "other.json")

    def fail():
        raise KeyError("a defect of the stream")

    with pytest.raises(KeyError):
        loading.ask(request(calibration_file), fail)
    answered = loading.ask(request(tmp_path / "other.json"), nothing)
    assert answered.calibration.calibration_id == other.calibration_id


def test_where_no_process_can_be_started_requests_say_so_until_one_can(monkeypatch, calibration_file):
    with monkeypatch.context() as patch:
        patch.setattr(sys, "executable", "/nowhere/python")
        loading = LoadingProcess()
        with pytest.raises(ChildProcessError, match=r"cannot be started \(No such file or directory\)"):
            loading.ask(request(calibration_file), nothing)
    assert loading.ask(request(calibration_file), nothing)
    loading.close()


def test_processes_that_cannot_even_be_killed_do_not_pile_up(monkeypatch, calibration_file):
    loading = LoadingProcess(patience=0.02)
    with monkeypatch.context() as patch:
        patch.setattr(subprocess.Popen, "kill", lambda _: None)
        for _ in range(module.MOST_HANGING + 3):
            for number in children():
                os.kill(number, signal.SIGSTOP)
            with pytest.raises((TimeoutError, ChildProcessError)):
                loading.ask(request(calibration_file), nothing)
        assert len(children()) == module.MOST_HANGING + 1
    for killed in loading._killed:
        killed.kill()
    loading.close()
    assert not children()


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM])
def test_it_ends_with_its_parent_however_that_ends(number):
    parent = subprocess.Popen([sys.executable, "-c", PARENT], stdout=subprocess.PIPE)
    assert parent.stdout.readline() == b"ready\n"
    (loading,) = children_of(parent.pid)
    parent.send_signal(number)
    parent.wait()
    wait_until_gone(loading)
    parent.stdout.close()
