"""Fixtures of all tests."""

import os
from pathlib import Path

# Linear algebra here is small: threads gain nothing, and on a busy machine they wait for each other. Read when numpy
# is imported, and handed on to the processes that tests start.
os.environ.setdefault("OMP_NUM_THREADS", "1")

import pytest
from builders import make_calibration
from hypothesis import settings

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.calibration.document import write_calibration
from hgma_compensation.demo import ros_domain
from hgma_compensation.demo.processes import private_ros_environment

# The same examples on every run and no deadline: a test's verdict must not depend on the machine.
settings.register_profile("repeatable", derandomize=True, deadline=None, print_blob=True)
settings.load_profile("repeatable")


@pytest.fixture
def calibration() -> Calibration:
    """Return a valid calibration: three channels, networks, no filter."""
    return make_calibration()


@pytest.fixture
def calibration_file(calibration: Calibration, tmp_path: Path) -> Path:
    """Return the path of that calibration's file, alone in its folder."""
    write_calibration(calibration, tmp_path / "sensor.json")
    return tmp_path / "sensor.json"


@pytest.fixture(autouse=True)
def domains_are_given_back():
    """Give up what a test took of the machine's hundred ROS domains, once all that talked there has ended."""
    kept = ros_domain.held()
    yield
    ros_domain.give_back(kept)


@pytest.fixture
def environment():
    """Variables of a ROS of its own for the processes of a test."""
    return private_ros_environment()


@pytest.fixture
def robot(environment):
    """The test's peer on that ROS."""
    from robot import Robot  # loads rclpy, which most tests do without

    peer = Robot(int(environment["ROS_DOMAIN_ID"]))
    yield peer
    peer.close()
