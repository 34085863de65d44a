"""The soak of killed nodes, shortened."""

import pytest

from benchmarks.soak.kills import LARGEST_ERROR, soak

pytestmark = [pytest.mark.ros, pytest.mark.slow]


def test_killed_at_random_moments_every_life_takes_up_the_memory_of_the_one_before(tmp_path):
    figures = soak(kills=2, writers=60, seed=3, folder=tmp_path)
    assert figures["files_that_load"] == 60
    assert figures["while_writing"] > 0
    assert figures["states_seen"] > 1
    assert figures["taken_up"] == figures["kills"] == 2
    assert figures["least_lost_without_memory"] > 5.0
    assert figures["largest_error"] < LARGEST_ERROR * figures["least_lost_without_memory"]
