"""The measured chamber recording; left out where it is not present."""

import numpy as np
import pytest

from benchmarks.chamber_table import measure
from hgma_compensation.measured_data import VARIABLE, chamber_table
from hgma_compensation.training.methods import Method

RECORDING = chamber_table()
pytestmark = pytest.mark.skipif(RECORDING is None, reason=f"no measured data: set {VARIABLE} to its folder")


@pytest.mark.slow
def test_the_network_is_no_worse_than_the_cubic_with_rate_terms_on_the_cooling_held_out():
    figures = measure(RECORDING, seeds=(1, 2, 3, 4, 5)).methods
    network = np.median(figures[Method.RBF_GA], axis=0)
    assert (network <= figures[Method.POLYNOMIAL_RATE][0]).all()
    assert (network <= 0.7 * figures[Method.POLYNOMIAL][0]).all()
    assert (network <= np.median(figures[Method.RBF], axis=0)).all()
