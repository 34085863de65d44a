import numpy as np
import pytest
from builders import triangle

from hgma_compensation.drift.polynomial import CUBIC, CUBIC_WITH_RATE
from hgma_compensation.training.folds import Folds
from hgma_compensation.training.polynomial_fit import fit_polynomial, polynomial_fitness

SEED = 20190725
TEMPERATURE = triangle(np.arange(0.0, 1200.0, 4.0), 400.0)
RATE = np.random.default_rng(SEED).uniform(-0.1, 0.1, len(TEMPERATURE))
FEATURES = np.column_stack([TEMPERATURE, RATE, TEMPERATURE * RATE])
FOLDS = Folds(np.arange(len(TEMPERATURE)) // 100, 3, "temperature cycles")
CUBIC_DRIFT = 1.0 - 0.3 * TEMPERATURE + 0.002 * TEMPERATURE**2 + 1e-5 * TEMPERATURE**3
RATE_DRIFT = 20.0 * RATE - 0.4 * TEMPERATURE * RATE


@pytest.mark.parametrize(("exponents", "drift"), [(CUBIC, CUBIC_DRIFT), (CUBIC_WITH_RATE, CUBIC_DRIFT + RATE_DRIFT)])
def test_drift_of_its_own_form_is_recovered(exponents, drift):
    found = fit_polynomial(FEATURES, drift, exponents)
    # What is left is the bias of the penalty, 1e-12 of the coefficients in scaled inputs.
    np.testing.assert_allclose(found.evaluate(FEATURES), drift, rtol=0.0, atol=1e-9 * np.ptp(drift))
    assert polynomial_fitness(FEATURES, drift, exponents, FOLDS) <= 1e-9 * np.ptp(drift)


def test_cubic_equals_numpys_least_squares():
    drift = CUBIC_DRIFT + RATE_DRIFT + np.random.default_rng(SEED).standard_normal(len(TEMPERATURE))
    expected = np.polynomial.Polynomial.fit(TEMPERATURE, drift, 3)(TEMPERATURE)
    found = fit_polynomial(FEATURES, drift, CUBIC).evaluate(FEATURES)
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-9 * np.ptp(drift))


def test_fitness_is_the_error_on_folds_left_out():
    drift = CUBIC_DRIFT + RATE_DRIFT + np.random.default_rng(SEED).standard_normal(len(TEMPERATURE))
    error = np.empty(len(drift))
    for fold in range(FOLDS.count):
        out = FOLDS.index == fold
        fit = np.polynomial.Polynomial.fit(TEMPERATURE[~out], drift[~out], 3)
        error[out] = drift[out] - fit(TEMPERATURE[out])
    assert polynomial_fitness(FEATURES, drift, CUBIC, FOLDS) == pytest.approx(np.sqrt(np.mean(error**2)), rel=1e-6)


def test_feature_that_never_varies_is_harmless():
    still = FEATURES * [1.0, 0.0, 0.0]
    found = fit_polynomial(still, CUBIC_DRIFT, CUBIC_WITH_RATE)
    assert np.isfinite(found.coefficients).all()
    assert polynomial_fitness(still, CUBIC_DRIFT, CUBIC_WITH_RATE, FOLDS) <= 1e-9 * np.ptp(CUBIC_DRIFT)
    np.testing.assert_allclose(found.evaluate(still), CUBIC_DRIFT, rtol=0.0, atol=1e-9 * np.ptp(CUBIC_DRIFT))
