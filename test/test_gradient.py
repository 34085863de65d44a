import numpy as np
import pytest
from builders import triangle, true_drift

from hgma_compensation.drift.radial_basis import basis
from hgma_compensation.training.gradient import EPOCHS, MOMENTUM, train_by_gradient

SEED = 20190725
TEMPERATURE = triangle(np.arange(0.0, 1200.0, 5.0), 600.0)
FEATURES = np.column_stack([TEMPERATURE, np.gradient(TEMPERATURE, 5.0), 3.0 * TEMPERATURE])
TARGET = true_drift(TEMPERATURE)


def test_same_seed_gives_the_same_network():
    first, again, other = (train_by_gradient(FEATURES, TARGET, seed=seed) for seed in (SEED, SEED, SEED + 1))
    for name in ("centres", "widths", "coefficients"):
        assert getattr(first, name).tobytes() == getattr(again, name).tobytes()
    assert first.centres.tobytes() != other.centres.tobytes()


@pytest.mark.parametrize("centres", [1, 4, 15])
def test_width_is_haykins_and_there_are_no_linear_terms(centres):
    drift = train_by_gradient(FEATURES, TARGET, seed=SEED, centres=centres)
    pairs = np.linalg.norm(drift.centres[:, None] - drift.centres[None], axis=2)
    assert drift.centres.shape == (centres, 3)
    np.testing.assert_allclose(drift.widths, max(pairs.max(), 1e-6) / np.sqrt(2.0 * centres), rtol=1e-14)
    np.testing.assert_array_equal(drift.linear, np.zeros(3))


def test_weights_are_those_of_the_descent_in_closed_form():
    drift = train_by_gradient(FEATURES, TARGET, seed=SEED)
    columns = basis(drift.scaling.apply(FEATURES), drift.centres, drift.widths)[:, : len(drift.weights) + 1]
    curvature, directions = np.linalg.eigh(columns.T @ columns / len(TARGET))
    pull = directions.T @ (columns.T @ TARGET) / len(TARGET)
    rate = 1.0 / curvature[-1]
    modes = []
    for own_curvature, own_pull in zip(curvature, pull, strict=True):
        # (w, w before, 1) after one step of Eq. (6) with momentum along an eigenvector.
        step = np.array([[1 + MOMENTUM - rate * own_curvature, -MOMENTUM, rate * own_pull], [1, 0, 0], [0, 0, 1]])
        modes.append((np.linalg.matrix_power(step, EPOCHS) @ [0.0, 0.0, 1.0])[0])
    expected = columns @ directions @ np.array(modes)
    np.testing.assert_allclose(drift.evaluate(FEATURES), expected, rtol=0.0, atol=1e-8 * np.ptp(TARGET))


def test_error_lies_between_least_squares_and_none():
    drift = train_by_gradient(FEATURES, TARGET, seed=SEED)
    columns = basis(drift.scaling.apply(FEATURES), drift.centres, drift.widths)[:, : len(drift.weights) + 1]
    best = TARGET - columns @ np.linalg.lstsq(columns, TARGET, rcond=None)[0]
    error = TARGET - drift.evaluate(FEATURES)
    assert best.std() <= error.std() < 0.1 * TARGET.std()
