import numpy as np
import pytest

from hgma_compensation.drift.model import CalibratedRange

BOX = CalibratedRange(np.array([-10.0, -0.1, -100.0]), np.array([60.0, 0.1, 300.0]))


def test_points_inside_and_on_the_edge_are_contained_and_kept():
    inside = np.array([[25.0, 0.0, 0.0], BOX.lower, BOX.upper])
    assert BOX.contains(inside).all()
    np.testing.assert_array_equal(BOX.clamp(inside), inside)


@pytest.mark.parametrize("column", [0, 1, 2])
@pytest.mark.parametrize("side", ["lower", "upper"])
def test_point_beyond_one_side_is_outside_and_moved_to_that_side_only(column, side):
    point = BOX.middle[None].copy()
    away = -np.inf if side == "lower" else np.inf
    for beyond in (np.nextafter(getattr(BOX, side)[column], away), away):
        point[0, column] = beyond
        assert not BOX.contains(point).any()
        expected = BOX.middle.copy()
        expected[column] = getattr(BOX, side)[column]
        np.testing.assert_array_equal(BOX.clamp(point)[0], expected)


@pytest.mark.parametrize("column", [0, 1, 2])
def test_row_with_nan_is_outside_and_no_other_row(column):
    points = np.tile(BOX.middle, (3, 1))
    points[1, column] = np.nan
    np.testing.assert_array_equal(BOX.contains(points), [True, False, True])


def test_range_of_training_features_has_a_margin_on_each_side():
    features = np.array([[0.0, -1.0, 5.0], [50.0, 1.0, 5.0], [20.0, 0.0, 5.0]])
    box = CalibratedRange.of(features)
    np.testing.assert_allclose(box.lower, [-1.0, -1.04, 5.0], rtol=1e-15)
    np.testing.assert_allclose(box.upper, [51.0, 1.04, 5.0], rtol=1e-15)
    assert box.contains(features).all()


def test_middle_is_halfway():
    np.testing.assert_allclose(BOX.middle, [25.0, 0.0, 100.0], atol=1e-15)
