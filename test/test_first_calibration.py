"""The calibration that is read before there is a stream."""

import threading

import pytest

from hgma_compensation.errors import RefusedError
from hgma_compensation.loading.job import Request
from hgma_compensation.pipeline.live import LiveCompensation

pytestmark = pytest.mark.ros


@pytest.fixture
def module():
    from hgma_compensation.node import calibration_loader  # loads rclpy

    return calibration_loader


def request(path, sensor_id=""):
    return Request(path, None, sensor_id, LiveCompensation().histories())


def test_it_is_what_the_loading_process_would_return(module, calibration_file, calibration):
    assert module.answer_of_thread(request(calibration_file)).calibration.calibration_id == calibration.calibration_id


def test_one_that_is_refused_says_why(module, calibration_file):
    with pytest.raises(RefusedError, match="expected_sensor_id is 'another'"):
        module.answer_of_thread(request(calibration_file, "another"))


def test_a_disk_that_does_not_answer_is_given_up(module, monkeypatch, calibration_file):
    disk = threading.Event()
    monkeypatch.setattr(module, "PATIENCE", 0.05)
    monkeypatch.setattr(module, "answer", lambda _: disk.wait(30.0))
    with pytest.raises(TimeoutError, match=r"not done within 0\.05 s"):
        module.answer_of_thread(request(calibration_file))
    disk.set()


def test_a_defect_is_raised_and_not_taken_for_a_disk(module, monkeypatch, calibration_file):
    def broken(_):
        raise ZeroDivisionError("a defect")

    monkeypatch.setattr(module, "answer", broken)
    with pytest.raises(ZeroDivisionError, match="a defect"):
        module.answer_of_thread(request(calibration_file))
