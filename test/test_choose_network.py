from dataclasses import replace

import numpy as np
import pytest
from test_genetic import FEATURES, FOLDS, NOISE, QUICK, SEED, bits

from hgma_compensation.training import methods
from hgma_compensation.training.genetic import Criterion, search_network
from hgma_compensation.training.methods import GAIN, SEARCHES, STRAIGHT, choose_network

SPAN = FEATURES[:, 1] / FEATURES[:, 1].std()
RANDOM = np.random.default_rng(SEED).standard_normal(len(FEATURES))
STRAIGHT_TARGET = 0.7 * FEATURES[:, 0] + 20.0 * SPAN + NOISE * RANDOM
BENT_TARGET = STRAIGHT_TARGET + 20.0 * SPAN**2


def choose(target, stop_at=0.0, progress=None):
    return choose_network(FEATURES, target, FOLDS, seed=SEED, stop_at=stop_at, settings=QUICK, progress=progress)


def is_straight(found):
    return bool(np.all(found.drift.widths[:, 1:] >= STRAIGHT[0] * (1.0 - 1e-12)))


def test_drift_in_proportion_to_the_rate_is_left_straight():
    assert is_straight(choose(STRAIGHT_TARGET))


def test_drift_that_bends_with_the_rate_gets_the_very_network_of_the_plain_search():
    found = choose(BENT_TARGET)
    assert not is_straight(found)
    plain = search_network(FEATURES, BENT_TARGET, FOLDS, seed=SEED, stop_at=0.0, settings=QUICK)
    assert bits(found.drift) == bits(plain.drift)
    assert found.fitness == plain.fitness


def test_the_same_seed_chooses_the_same_network():
    assert bits(choose(STRAIGHT_TARGET).drift) == bits(choose(STRAIGHT_TARGET).drift)


@pytest.fixture
def searches(monkeypatch):
    """The searches that are made, in their order: criterion, and what was found. The last may be made worse."""
    made, worse = [], [1.0]

    def watched(*arguments, criterion, **rest):
        found = search_network(*arguments, criterion=criterion, **rest)
        if criterion is Criterion.LIKELIHOOD:
            found = replace(found, fitness=worse[0] * straight_error(made))
        made.append((criterion, found))
        return found

    monkeypatch.setattr(methods, "search_network", watched)
    return made, worse


def straight_error(made):
    return made[0][1].fitness


@pytest.mark.parametrize(
    ("factor", "likeliest"), [(0.5, True), (0.99 / (1.0 - GAIN), True), (1.01 / (1.0 - GAIN), False)]
)
def test_the_likeliest_straight_network_is_taken_unless_the_folds_prove_it_worse(searches, factor, likeliest):
    made, worse = searches
    worse[0] = factor
    found = choose(STRAIGHT_TARGET)
    assert [criterion for criterion, _ in made] == [Criterion.LEFT_OUT, Criterion.LEFT_OUT, Criterion.LIKELIHOOD]
    assert found is made[2 if likeliest else 0][1]


def test_a_network_that_is_proven_to_bend_is_not_compared_by_likelihood(searches):
    made, _ = searches
    found = choose(BENT_TARGET)
    assert [criterion for criterion, _ in made] == [Criterion.LEFT_OUT, Criterion.LEFT_OUT]
    assert found is made[1][1]


@pytest.mark.parametrize(("target", "made"), [(STRAIGHT_TARGET, SEARCHES), (BENT_TARGET, 2)], ids=["straight", "bent"])
def test_progress_goes_once_from_the_first_generation_to_the_last_and_never_gets_worse(target, made):
    heard = []
    choose(target, progress=lambda generation, best: heard.append((generation, best)))
    generations, best = np.array(heard).T
    assert len(heard) == made * QUICK.generations
    assert (generations[0], generations[-1]) == (1, QUICK.generations * made // SEARCHES)
    assert set(np.diff(generations)) == {0.0, 1.0}
    assert np.all(np.diff(best) <= 0.0)


def test_a_network_at_the_noise_needs_no_second_search():
    heard = []
    found = choose(STRAIGHT_TARGET, 10.0 * STRAIGHT_TARGET.std(), lambda generation, _: heard.append(generation))
    assert heard == [1]
    assert found.generations == 1
    assert is_straight(found)
