"""Fixtures of all tests."""

import pytest
from builders import make_calibration
from hypothesis import settings

from hgma_compensation.calibration.calibration import Calibration

# The same examples on every run and no deadline: a test's verdict must not depend on the machine.
settings.register_profile("repeatable", derandomize=True, deadline=None, print_blob=True)
settings.load_profile("repeatable")


@pytest.fixture
def calibration() -> Calibration:
    """Return a valid calibration: three channels, networks, no filter."""
    return make_calibration()
