import numpy as np
import pytest
from builders import triangle

from hgma_compensation.training.blocks import Blocks
from hgma_compensation.training.folds import MOST_FOLDS, TURN, cycle_folds, half_cycles, turning_points

SEED = 20190725
LOW, HIGH, NOISE = -10.0, 60.0, 0.5
PERIOD = 200


def sweeps(count, seed=SEED):
    """Temperature (°C) of as many sweeps of 100 blocks each, with bounded noise."""
    noise = np.random.default_rng(seed).uniform(-NOISE, NOISE, count * PERIOD // 2)
    return triangle(np.arange(count * PERIOD // 2), PERIOD, LOW, HIGH) + noise


def blocks(*temperatures):
    n = [len(t) for t in temperatures]
    features = np.zeros((sum(n), 3))
    features[:, 0] = np.concatenate(temperatures)
    time = np.concatenate([5.0 * np.arange(k) for k in n])
    return Blocks(time, np.repeat(np.arange(len(n)), n), features, np.zeros((sum(n), 1)))


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("count", [1, 2, 5, 8])
def test_turning_points_of_a_noisy_triangle(count, sign):
    turns = turning_points(sign * sweeps(count), TURN * (HIGH - LOW))
    # Noise moves an extreme by no more than the time in which the ramp changes by the noise's whole width.
    slack = 2.0 * NOISE / ((HIGH - LOW) / (PERIOD // 2))
    assert len(turns) == count - 1
    assert np.all(np.abs(turns - PERIOD // 2 * np.arange(1, count)) <= slack)


def test_ripple_below_the_threshold_is_no_turning_point():
    ripple = 0.5 * 9.9 * np.sin(np.arange(400.0))
    assert turning_points(0.01 * np.arange(400.0) + ripple, 10.0) == []
    assert turning_points(0.01 * np.arange(400.0) + ripple, 9.0) != []


def test_constant_temperature_has_no_turning_point():
    assert turning_points(np.full(50, 20.0), 0.0) == []


@pytest.mark.parametrize(("cycles", "folds"), [(2, 2), (3, 3), (6, 6), (8, MOST_FOLDS)])
def test_folds_are_whole_cycles(cycles, folds):
    table = blocks(sweeps(2 * cycles))
    found = cycle_folds(table)
    assert (found.count, found.kind) == (folds, "temperature cycles")
    np.testing.assert_array_equal(found.index, half_cycles(table) // 2 % MOST_FOLDS)
    for fold in range(folds):
        assert np.ptp(table.features[found.index == fold, 0]) > 0.95 * (HIGH - LOW)


@pytest.mark.parametrize("sweep_count", [2, 3])
def test_fewer_than_two_cycles_give_half_cycles(sweep_count):
    table = blocks(sweeps(sweep_count))
    found = cycle_folds(table)
    assert (found.count, found.kind) == (sweep_count, "half cycles of temperature")
    np.testing.assert_array_equal(found.index, half_cycles(table))


def test_single_sweep_is_split_into_stretches_of_time():
    found = cycle_folds(blocks(sweeps(1)))
    assert (found.count, found.kind) == (4, "stretches of a single sweep")
    # Each fold is left out at two places of the sweep, so that no end of it is only ever extrapolated.
    stretches = found.index[np.r_[True, np.diff(found.index) != 0]]
    np.testing.assert_array_equal(stretches, [0, 1, 2, 3, 0, 1, 2, 3])
    assert np.bincount(found.index).min() >= 100 // 4 - 2


@pytest.mark.parametrize("counts", [(1, 1), (3, 1), (2, 4, 1), (1,) * 9])
def test_recordings_never_share_a_half_cycle(counts):
    table = blocks(*(sweeps(count, SEED + k) for k, count in enumerate(counts)))
    numbers = half_cycles(table)
    np.testing.assert_array_equal(np.unique(numbers), np.arange(sum(counts)))
    for number in range(sum(counts)):
        assert len(np.unique(table.recording[numbers == number])) == 1


def test_every_fold_from_zero_to_count_is_in_use():
    for counts in [(1,), (2,), (3,), (5,), (15,), (3, 4), (1,) * 14]:
        found = cycle_folds(blocks(*(sweeps(count) for count in counts)))
        np.testing.assert_array_equal(np.unique(found.index), np.arange(found.count))
