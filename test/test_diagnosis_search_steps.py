"""Polish, cross-validation and lines, on problems with planted effects."""

from dataclasses import replace

import numpy as np
import pytest
from builders import EPOCH
from diagnosis_blocks import LASTS, lag_problem, plain_problem

from hgma_compensation.diagnosis.confirm import residue
from hgma_compensation.diagnosis.cross_validation import INTERLEAVED, TIME_FOLDS, folds_for, share_of_folds, sweeps
from hgma_compensation.diagnosis.lines import line_candidates, power_spectrum
from hgma_compensation.diagnosis.polish import answered, finding_form, polish, searched_parameter, side_by_side
from hgma_compensation.diagnosis.problem import Problem, State, without_rows
from hgma_compensation.effects.aging import Aging
from hgma_compensation.effects.periodic_interference import PeriodicInterference
from hgma_compensation.effects.stress_relaxation import StressRelaxation
from hgma_compensation.effects.thermal_gradient import ThermalGradient
from hgma_compensation.effects.thermal_lag import ThermalLag

TRUE = 45.0


def lag(time_constant):
    return ThermalLag(time_constant, -10.0, 60.0, 0.0)


def with_added(problem, extra):
    """Return a problem with something (n,) added to its means."""
    blocks = replace(problem.scene.blocks, values=problem.values + extra)
    return replace(problem, scene=replace(problem.scene, blocks=blocks), cache={})


def wave(problem, period, size):
    seconds = (problem.scene.blocks.stamps - EPOCH) * 1e-9
    return size * np.sin(2.0 * np.pi * seconds / period + 0.7)


@pytest.fixture(scope="module")
def lagging():
    return State.of(lag_problem(), [lag(TRUE)]).with_effects([], [])


@pytest.fixture(scope="module")
def plain():
    return State.of(plain_problem(), [])


# Polish -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("start", [25.0, 60.0, 100.0])
def test_polish_finds_the_time_constant_of_a_planted_lag(lagging, start):
    first = lagging.score([lag(start)])[0]
    found = polish(first, lagging.score, lagging.problem.survey)
    assert found.effect.time_constant == pytest.approx(TRUE, rel=0.02)
    assert found.bic < first.bic


def test_polish_leaves_alone_what_has_nothing_to_look_for(lagging):
    first = lagging.score([ThermalGradient()])[0]
    assert searched_parameter(first.effect) is None
    assert polish(first, lagging.score, lagging.problem.survey) is first


def test_polish_stays_inside_the_limits(lagging):
    first = lagging.score([StressRelaxation(510.0, 1.0)])[0]
    found = polish(first, lagging.score, lagging.problem.survey)
    found.effect.check()
    assert found.bic <= first.bic


def test_searches_side_by_side_find_what_each_finds_alone(lagging):
    survey, asked = lagging.problem.survey, []

    def score(effects):
        asked.append(len(effects))
        return lagging.score(effects)

    # One that takes many rounds, one that takes none, and one whose forms have several poles.
    starts = lagging.score([lag(60.0), ThermalGradient(), StressRelaxation(300.0, 1.0)])
    together = answered(side_by_side([finding_form(start, survey) for start in starts]), score)
    rounds = len(asked)
    alone = [answered(finding_form(start, survey), score) for start in starts]
    assert [found.effect for found in together] == [found.effect for found in alone]
    assert [found.bic for found in together] == [found.bic for found in alone]
    assert rounds < len(asked) - rounds
    assert sum(asked[:rounds]) == sum(asked[rounds:])


def test_no_search_at_all_finds_nothing(lagging):
    assert answered(side_by_side([]), lagging.score) == []


def test_the_planted_lag_leaves_only_noise_and_its_gain_is_found(lagging):
    problem = lagging.problem
    state = State.of(problem, [lag(TRUE)])
    weights, left = state.fit()
    assert weights[-1] == pytest.approx(0.6, rel=0.02)
    assert left.std() == pytest.approx(0.3 / np.sqrt(20.0), rel=0.2)
    assert residue(state, problem).slow.p_value > 1e-3
    assert residue(State.of(problem, []).with_effects([], []), problem).residual.std() > 1.5 * left.std()


# Cross-validation ---------------------------------------------------------------------------------------


def test_a_planted_lag_predicts_the_cycles_that_it_was_not_fitted_to(lagging):
    effect = lag(TRUE)
    share, fall = share_of_folds(lagging, lagging.problem.columns([effect])[0], folds_for(lagging, effect))
    assert share == 1.0
    assert fall > 100.0


def test_what_is_not_there_predicts_nothing(plain):
    random = np.random.default_rng(3)
    shares, falls = [], []
    for _ in range(10):
        columns = random.standard_normal((len(plain.problem.values), 3))
        share, fall = share_of_folds(plain, columns, folds_for(plain, lag(TRUE)))
        shares.append(share)
        falls.append(fall)
    assert np.mean(falls) < 0.0
    assert np.mean(shares) < 0.6


def test_cycles_are_left_out_for_what_temperature_drives_and_stretches_for_what_time_does(lagging):
    blocks = lagging.problem.scene.blocks
    cycles = folds_for(lagging, lag(TRUE))
    changes = np.sum((np.diff(cycles) != 0) | (np.diff(blocks.run) != 0))
    assert sweeps(lagging.problem) >= 10
    assert len(np.unique(cycles)) - 1 <= changes <= 8
    stretches = folds_for(lagging, Aging(1e9, EPOCH, 1e6))
    seconds = (blocks.stamps - blocks.stamps.min()) * 1e-9
    np.testing.assert_array_equal(stretches, np.floor(seconds / INTERLEAVED) % TIME_FOLDS)
    np.testing.assert_array_equal(stretches, folds_for(lagging, PeriodicInterference(100.0, EPOCH)))


# Lines --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("period", [37.7, 97.3])
def test_a_planted_line_is_found_at_its_period(period):
    state = State.of(with_added(plain_problem(), wave(plain_problem(), period, 0.1)), [])
    found = line_candidates(state)
    best = max(state.score(found), key=lambda scored: scored.gain)
    assert best.name == "periodic_interference"
    polished = polish(best, state.score, state.problem.survey)
    # Much finer than one run would tell; a turn more or less in the day between the runs is hard to see.
    assert abs(1.0 / polished.effect.period - 1.0 / period) < 0.1 / LASTS
    assert residue(state, state.problem).line_p_value < 1e-6
    without = State.of(state.problem, [polished.effect])
    assert residue(without, without.problem).line_p_value > 1e-3
    assert np.hypot(*without.fit()[0][-2:]) == pytest.approx(0.1, rel=0.1)


def test_without_a_line_the_spectrum_is_flat(plain):
    white = residue(plain, plain.problem).white
    frequencies, power = power_spectrum(plain.problem, white)
    assert np.mean(power) == pytest.approx(1.0, rel=0.15)
    assert 1.0 / frequencies[-1] > 2.0 * plain.problem.block
    assert residue(plain, plain.problem).line_p_value > 1e-3


def test_runs_too_short_for_a_line_have_no_spectrum(plain):
    problem: Problem = plain.problem
    few = np.zeros(len(problem.values), dtype=bool)
    few[:12] = True
    frequencies, power = power_spectrum(without_rows(problem, few), np.ones(12))
    assert len(frequencies) == len(power) == 0


def test_a_state_is_solved_once_whether_its_covariance_waits_in_a_file_or_not():
    state = State.of(plain_problem(), [lag(TRUE)])
    weights, residual = state.fit()
    root = state.solution[1]
    assert root.tobytes() == state.solve(state.known)[1].tobytes()
    again = State.of(state.problem, state.effects)
    again.whitener.put_away()
    assert again.fit()[0].tobytes() == weights.tobytes()
    assert again.fit()[1].tobytes() == residual.tobytes()
    assert state.fit()[0] is weights
