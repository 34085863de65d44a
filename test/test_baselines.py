import numpy as np
import pytest

from hgma_compensation.training.baselines import draw, fit_gaussian_process, fit_kernel_ridge, fit_thin_plate
from hgma_compensation.training.folds import Folds

NOISE = 0.5


def made(seed, count=400):
    """Features over five cycles, and a smooth drift of them with noise."""
    random = np.random.default_rng(seed)
    phase = np.linspace(0.0, 5.0, count, endpoint=False)
    temperature = 25.0 + 35.0 * np.cos(2.0 * np.pi * phase)
    rate = random.uniform(-0.03, 0.03, count)
    features = np.column_stack([temperature, rate, 60.0 * temperature * rate])
    x = (temperature - 25.0) / 35.0
    drift = 100.0 * x + 20.0 * np.tanh(2.0 * x) + 300.0 * rate
    return features, drift, drift + NOISE * random.standard_normal(count), Folds(phase.astype(int), 5, "cycles")


def rms(error):
    return float(np.sqrt(np.mean(error**2)))


def test_all_fit_a_smooth_drift_to_less_than_its_noise():
    features, _, noisy, folds = made(seed=1)
    others, drift, _, _ = made(seed=2)
    assert rms(fit_gaussian_process(features, noisy, seed=1, points=200).evaluate(others) - drift) < NOISE
    assert rms(fit_thin_plate(features, noisy, folds, seed=1).evaluate(others) - drift) < 2.0 * NOISE
    assert rms(fit_kernel_ridge(features, noisy, folds).evaluate(others) - drift) < NOISE


def test_the_same_seed_gives_the_same_fit():
    features, _, noisy, _ = made(seed=3)
    first, second = (fit_gaussian_process(features, noisy, seed=7, points=60).evaluate(features) for _ in range(2))
    assert (first == second).all()


def test_the_thin_plate_smooths_noise_more_than_it_smooths_none():
    features, drift, noisy, folds = made(seed=4, count=200)
    clean = fit_thin_plate(features, drift, folds, seed=1)
    assert fit_thin_plate(features, drift + 20.0 * (noisy - drift), folds, seed=1).smoothing > clean.smoothing


@pytest.mark.parametrize("count", [0, 1, 20_000])
def test_any_number_of_rows_can_be_asked_for(count):
    features, _, noisy, folds = made(seed=5, count=100)
    rows = np.repeat(features[:1], count, axis=0)
    for fit in (
        fit_gaussian_process(features, noisy, seed=1, points=50),
        fit_thin_plate(features, noisy, folds, seed=1),
        fit_kernel_ridge(features, noisy, folds),
    ):
        assert fit.evaluate(rows).shape == (count,)


def test_kernel_ridge_does_not_hear_the_unit_or_the_level_of_the_target():
    features, _, noisy, folds = made(seed=8, count=150)
    first, other = (fit_kernel_ridge(features, target, folds) for target in (noisy, 1024.0 * noisy + 5000.0))
    np.testing.assert_allclose(other.evaluate(features), 1024.0 * first.evaluate(features) + 5000.0, rtol=1e-9)


def test_a_target_that_never_changes_is_fitted():
    features, _, _, folds = made(seed=6, count=60)
    assert fit_thin_plate(features, np.zeros(60), folds, seed=1).evaluate(features) == pytest.approx(0.0, abs=1e-9)


def test_draw_takes_all_or_a_seeded_choice_in_order():
    assert (draw(5, 10, seed=1) == np.arange(5)).all()
    chosen = draw(1000, 50, seed=1)
    assert len(set(chosen.tolist())) == 50
    assert (np.diff(chosen) > 0).all()
    assert (chosen == draw(1000, 50, seed=1)).all()
