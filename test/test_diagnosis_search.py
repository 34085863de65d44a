import numpy as np
import pytest
from diagnosis_blocks import no_whitening

from hgma_compensation.diagnosis.baseline import independent
from hgma_compensation.diagnosis.search import Projection, score, searched_count
from hgma_compensation.diagnosis.whitener import Whitener
from hgma_compensation.effects.stress_relaxation import StressRelaxation
from hgma_compensation.effects.thermal_gradient import ThermalGradient

COUNT = 200
RANDOM = np.random.default_rng(1)
KNOWN, COLUMNS, TARGET = (RANDOM.standard_normal((COUNT, k)) for k in (5, 2, 1))
TARGET = TARGET[:, 0] + KNOWN @ np.arange(1.0, 6.0) + COLUMNS @ np.array([0.5, -0.3])


def correlated():
    """Return a whitener and the covariance that it takes away."""
    lags = np.abs(np.subtract.outer(np.arange(COUNT), np.arange(COUNT)))
    covariance = 0.9**lags + 0.5 * np.eye(COUNT)
    return Whitener((np.linalg.cholesky(covariance),), (np.arange(COUNT),)), covariance


def left_by(columns, covariance):
    """Return the generalised residual sum of squares of the target."""
    root = np.linalg.inv(np.linalg.cholesky(covariance))
    white, target = root @ columns, root @ TARGET
    return float(np.sum((target - white @ np.linalg.lstsq(white, target, rcond=None)[0]) ** 2))


def test_gain_is_the_fall_of_the_residual_sum_of_squares():
    whitener, covariance = correlated()
    projection = Projection.of(whitener, KNOWN, TARGET)
    assert projection.residual @ projection.residual == pytest.approx(left_by(KNOWN, covariance))
    scored = score(projection, [ThermalGradient()], [COLUMNS])[0]
    fall = left_by(KNOWN, covariance) - left_by(np.hstack([KNOWN, COLUMNS]), covariance)
    assert scored.gain == pytest.approx(fall)
    assert scored.rank == 2
    assert scored.bic == pytest.approx(-fall + 2.0 * np.log(COUNT))


def test_a_parameter_that_is_looked_for_counts():
    creep = StressRelaxation(900.0, 1.0)
    assert searched_count(creep) == 1
    assert searched_count(ThermalGradient()) == 0
    projection = Projection.of(no_whitening(COUNT), KNOWN, TARGET)
    two, one = score(projection, [ThermalGradient(), creep], [COLUMNS[:, :1]] * 2)
    assert two.gain == one.gain
    assert one.bic - two.bic == pytest.approx(np.log(COUNT))


def test_columns_that_the_baseline_has_are_of_rank_0():
    whitener, _ = correlated()
    projection = Projection.of(whitener, KNOWN, TARGET)
    same = KNOWN @ np.random.default_rng(2).standard_normal((5, 3))
    for columns in (KNOWN, same, 1e6 * same, np.zeros((COUNT, 2))):
        scored = score(projection, [ThermalGradient()], [columns])[0]
        assert (scored.rank, scored.gain) == (0, 0.0)
    half = score(projection, [ThermalGradient()], [np.column_stack([KNOWN[:, 0], COLUMNS[:, 0]])])[0]
    assert half.rank == 1


def test_columns_that_are_added_are_known_from_then_on():
    whitener, _ = correlated()
    projection = Projection.of(whitener, KNOWN, TARGET).added(COLUMNS)
    at_once = Projection.of(whitener, np.hstack([KNOWN, COLUMNS]), TARGET)
    np.testing.assert_allclose(projection.residual, at_once.residual, atol=1e-9)
    assert score(projection, [ThermalGradient()], [COLUMNS])[0].rank == 0
    np.testing.assert_allclose(projection.known.T @ projection.known, np.eye(7), atol=1e-9)


@pytest.mark.parametrize("dropped", [(), (1, 4)])
def test_columns_that_may_be_lost_span_the_same_to_the_bit(dropped):
    columns = np.asfortranarray(np.random.default_rng(5).standard_normal((60, 6)))
    columns[:, list(dropped)] = 0.0
    expected = independent(columns)
    assert expected.shape == (60, 6 - len(dropped))
    assert independent(columns.copy(order="F"), overwrite=True).tobytes() == expected.tobytes()


def test_columns_that_are_asked_for_are_left_as_they_are():
    columns = np.asfortranarray(np.random.default_rng(5).standard_normal((60, 6)))
    before = columns.tobytes()
    independent(columns)
    assert columns.tobytes() == before
