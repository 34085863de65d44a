import numpy as np
import pytest
from builders import MEAN_TEMPERATURE, triangle, true_drift

from hgma_compensation.drift.radial_basis import basis
from hgma_compensation.training import genetic
from hgma_compensation.training.blocks import Blocks
from hgma_compensation.training.comparison import ridge_penalty
from hgma_compensation.training.folds import cycle_folds
from hgma_compensation.training.genetic import Criterion, GeneticSettings, search_network
from hgma_compensation.training.ridge import cross_validated_rms

SEED, NOISE = 20190725, 0.3
QUICK = GeneticSettings(centres=4, population=20, generations=12)


def cycles(periods, seed=SEED):
    """Features (n, 3) and drift (n,) of one block per 5 s in temperature cycles of the given periods (s)."""
    temperature = np.concatenate([triangle(np.arange(0.0, period, 5.0), period) for period in periods])
    rate = np.gradient(temperature, 5.0)
    features = np.column_stack([temperature, rate, temperature * 60.0 * rate])
    drift = true_drift(temperature) + 20.0 * rate + 0.1 * (temperature - MEAN_TEMPERATURE) * rate
    return features, drift, drift + NOISE * np.random.default_rng(seed).standard_normal(len(drift))


def folds_of(features):
    n = len(features)
    return cycle_folds(Blocks(5.0 * np.arange(n), np.zeros(n, dtype=np.int64), features, np.zeros((n, 1))))


FEATURES, DRIFT, TARGET = cycles([1200.0, 2000.0, 3000.0])
FOLDS = folds_of(FEATURES)


def search(seed=SEED, stop_at=0.0, settings=QUICK, target=TARGET, progress=None, criterion=Criterion.LEFT_OUT):
    return search_network(
        FEATURES,
        target,
        FOLDS,
        seed=seed,
        stop_at=stop_at,
        settings=settings,
        criterion=criterion,
        progress=progress,
    )


def bits(drift):
    return b"".join(part.tobytes() for part in (drift.centres, drift.widths, drift.coefficients))


def test_same_seed_gives_the_same_network_bit_for_bit_and_another_seed_another():
    first = search()
    assert bits(search().drift) == bits(first.drift)
    assert bits(search(seed=SEED + 1).drift) != bits(first.drift)


@pytest.mark.parametrize("criterion", Criterion)
@pytest.mark.parametrize("piece", [1, 7, 1000])
def test_result_does_not_depend_on_how_many_candidates_are_evaluated_at_once(monkeypatch, piece, criterion):
    first = search(criterion=criterion)
    monkeypatch.setattr(genetic, "PIECE", piece)
    assert bits(search(criterion=criterion).drift) == bits(first.drift)


def test_fitness_of_a_search_by_likelihood_is_the_error_on_left_out_folds():
    heard = []
    found = search(criterion=Criterion.LIKELIHOOD, progress=lambda _, fitness: heard.append(fitness))
    drift, columns = found.drift, basis(found.drift.scaling.apply(FEATURES), found.drift.centres, found.drift.widths)
    expected = cross_validated_rms(columns[None], TARGET, ridge_penalty(drift, FEATURES, TARGET)[None], FOLDS.index)
    assert found.fitness == pytest.approx(expected[0], rel=1e-3)
    assert found.fitness != heard[-1]
    assert np.all(np.diff(heard) <= 0.0)


def test_search_hears_no_global_random_numbers():
    np.random.seed(1)  # noqa: NPY002 - the global generator is the subject
    first = search()
    np.random.seed(2)  # noqa: NPY002
    assert bits(search().drift) == bits(first.drift)


def test_fitness_never_rises_and_the_last_one_is_the_result():
    reported = []
    found = search(progress=lambda generation, fitness: reported.append((generation, fitness)))
    numbers, fitness = np.array(reported).T
    np.testing.assert_array_equal(numbers, np.arange(1, QUICK.generations + 1))
    assert np.all(np.diff(fitness) <= 0.0)
    assert fitness[-1] < fitness[0]
    assert (found.generations, found.fitness) == (QUICK.generations, fitness[-1])


def test_search_stops_in_the_generation_that_reaches_delta():
    fitness = []
    search(progress=lambda _, best: fitness.append(best))
    middle = QUICK.generations // 2
    # One more than an improvement, so that the generation before it had not yet reached δ.
    until = next(k for k in range(middle, len(fitness)) if fitness[k] < fitness[k - 1])
    stop_at = 0.5 * (fitness[until] + fitness[until - 1])
    found = search(stop_at=stop_at)
    assert found.generations == until + 1
    assert found.fitness < stop_at
    assert search(stop_at=10.0 * TARGET.std()).generations == 1


def test_network_respects_the_bounds():
    settings = GeneticSettings(centres=3, population=20, generations=8, widths=((0.5, 0.9), (1.0, 2.0), (7.0, 8.0)))
    drift = search(settings=settings).drift
    inputs = drift.scaling.apply(FEATURES)
    low, high = np.array(settings.widths).T
    rounding = 1.0 + 4.0 * np.finfo(float).eps  # widths are searched as logarithms
    assert drift.centres.shape == drift.widths.shape == (3, 3)
    assert np.all((drift.widths >= low / rounding) & (drift.widths <= high * rounding))
    assert np.all((drift.centres >= inputs.min(axis=0)) & (drift.centres <= inputs.max(axis=0)))


def test_unit_of_the_target_changes_nothing_but_the_scale():
    first, scaled = search(), search(target=1024.0 * TARGET)
    np.testing.assert_array_equal(scaled.drift.centres, first.drift.centres)
    assert scaled.fitness == 1024.0 * first.fitness
    np.testing.assert_allclose(
        scaled.drift.evaluate(FEATURES), 1024.0 * first.drift.evaluate(FEATURES), rtol=0.0, atol=1e-6
    )


def test_known_drift_is_fitted_on_a_cycle_never_seen():
    found = search(settings=GeneticSettings(population=40, generations=60), stop_at=NOISE)
    unseen, truth, _ = cycles([1600.0])
    error = np.sqrt(np.mean((found.drift.evaluate(unseen) - truth) ** 2))
    # Fitness² is the noise² of the means left out, known within 4 standard errors of 1/√(2n), plus the network's own
    # error²: where it has come down to the noise, the latter is no more than what the former is uncertain by.
    uncertainty = 4.0 / np.sqrt(2.0 * len(TARGET))
    assert found.generations < 60
    assert NOISE * (1.0 - uncertainty) < found.fitness < NOISE
    assert error < NOISE * np.sqrt(2.0 * uncertainty)  # 0.12 of a drift of 50


@pytest.mark.parametrize("constant", [0.0, 9.81])
def test_target_without_any_drift_gives_a_flat_network(constant):
    drift = search(target=np.full(len(FEATURES), constant)).drift
    np.testing.assert_allclose(drift.evaluate(FEATURES), constant, rtol=0.0, atol=1e-6)
