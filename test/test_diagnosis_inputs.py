import numpy as np
import pytest
from diagnosis_blocks import make_blocks_of

from hgma_compensation.diagnosis.inputs import FEWEST_VISITS, JUMP, find_inputs

NOISE = 0.5


def held(visits, length=6, count=240, drift=3.0):
    """Return a drift with levels held for so many blocks: (place of the first block, level) each."""
    random = np.random.default_rng(1)
    deviation = drift * np.sin(np.arange(count) / 40.0) + NOISE * random.standard_normal(count)
    for first, level in visits:
        deviation[first : first + length] += level
    return make_blocks_of(deviation, white=NOISE**2), deviation


def test_without_motion_all_blocks_are_usable():
    found = find_inputs(*held([]))
    assert found.usable.all()
    assert not found.moving.any()
    assert found.columns.shape == (240, 0)


def test_levels_that_recur_are_one_column_each_for_both_signs():
    visits = [(20, 1000.0), (60, -1000.0), (100, 1000.0), (140, -1000.0)]
    visits += [(40, 3000.0), (80, 3000.0), (120, -3000.0), (160, -3000.0)]
    found = find_inputs(*held(visits))
    assert found.columns.shape == (240, 2)
    inner = slice(1, -1)  # the first and the last block of a visit hold the step itself
    for first, level in visits:
        place = np.arange(first, first + 6)
        assert found.moving[place].all()
        column = 0 if abs(level) < 2000.0 else 1
        np.testing.assert_array_equal(found.columns[place[inner], column], np.sign(level))
        assert found.usable[place[inner]].all()
        assert not found.usable[place[[0, -1]]].any()
        assert not found.usable[[first - 1, first + 6]].any()
    assert np.count_nonzero(found.columns) == 4 * len(visits)
    far = np.ones(240, dtype=bool)
    for first, _ in visits:
        far[first - 1 : first + 7] = False
    assert found.usable[far].all()
    assert not found.moving[far].any()


def test_motion_that_does_not_recur_is_left_out():
    visits = [(20 + 30 * k, 1000.0 * 1.5**k) for k in range(5)]
    found = find_inputs(*held(visits))
    assert found.columns.shape == (240, 0)
    for first, _ in visits:
        assert not found.usable[first - 1 : first + 7].any()


@pytest.mark.parametrize(("count", "columns"), [(FEWEST_VISITS - 1, 0), (FEWEST_VISITS, 1)])
def test_a_level_must_be_visited_often_enough(count, columns):
    found = find_inputs(*held([(20 + 30 * k, 1000.0) for k in range(count)]))
    assert found.columns.shape[1] == columns


def test_a_step_that_is_no_jump_is_drift():
    visits = [(20 + 30 * k, 0.5 * JUMP * NOISE) for k in range(5)]
    found = find_inputs(*held(visits))
    assert found.usable.all()
    assert not found.moving.any()


def test_a_level_that_stays_for_most_of_the_time_is_where_the_sensor_rests():
    deviation = np.concatenate([np.full(60, 1000.0), np.zeros(180)])
    found = find_inputs(make_blocks_of(deviation, white=NOISE**2), deviation)
    assert found.moving[:60].all()
    assert not found.moving[60:].any()
    assert found.usable[62:].all()
