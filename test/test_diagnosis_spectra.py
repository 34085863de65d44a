"""Spectra of memories on the first cooling and heating of the measured chamber recording; left out where it is not."""

import numpy as np
import pytest

from benchmarks.chamber_table import CHANNELS, load
from hgma_compensation.diagnosis.cross_validation import sweeps
from hgma_compensation.diagnosis.diagnose import FEWEST_SWEEPS
from hgma_compensation.diagnosis.prepare import prepare
from hgma_compensation.diagnosis.runs import make_run
from hgma_compensation.diagnosis.spectra import fit_spectra, memory_sets
from hgma_compensation.measured_data import CHAMBER_SPLIT, VARIABLE, chamber_table
from hgma_compensation.training.genetic import GeneticSettings
from hgma_compensation.training.train import TrainingOptions, train

RECORDING = chamber_table()
measured = pytest.mark.skipif(RECORDING is None, reason=f"no measured data: set {VARIABLE} to its folder")
BLOCK = 5.0


@pytest.fixture(scope="module")
def problems():
    recording = load(RECORDING, end=CHAMBER_SPLIT)
    calibration = train([recording], TrainingOptions(genetic=GeneticSettings(generations=5)))
    run = make_run(recording, calibration.features.noise)
    random = np.random.default_rng(1)
    return [prepare([run], calibration, channel, BLOCK, random) for channel in CHANNELS]


@pytest.fixture(scope="module")
def fitted(problems):
    return [fit_spectra(problem, np.random.default_rng(1), frozenset()) for problem in problems]


@measured
def test_one_cooling_and_one_heating_are_too_few_for_single_effects(problems):
    assert all(sweeps(problem) < FEWEST_SWEEPS for problem in problems)


@measured
@pytest.mark.parametrize("axis", [0, 1])
def test_x_and_y_have_memories(fitted, axis):
    state, spectra = fitted[axis]
    assert spectra.chosen.effects
    assert state.effects == spectra.chosen.effects
    plain = next(family for family in spectra.families if not family.effects)
    assert spectra.chosen.posterior.log_evidence > plain.posterior.log_evidence + 20.0
    assert spectra.p_value < 1e-3


@measured
@pytest.mark.parametrize("axis", [0, 1, 2])
def test_what_is_chosen_knows_the_sweep_back_better_than_a_static_map_does(fitted, axis):
    _, spectra = fitted[axis]
    if spectra.chosen.effects:
        assert spectra.chosen.deviation < spectra.static
    evidence = [family.posterior.log_evidence for family in spectra.families]
    assert evidence == sorted(evidence, reverse=True)
    ahead = spectra.families[: spectra.families.index(spectra.chosen)]
    assert all(family.deviation >= spectra.static for family in ahead)
    assert sum(share for share, _ in spectra.shares) == pytest.approx(1.0 if spectra.shares else 0.0)


@measured
def test_memories_leave_less_than_a_static_map(problems, fitted):
    for problem, (state, spectra) in zip(problems[:2], fitted[:2], strict=True):
        weights, _ = state.solve(np.hstack([problem.baseline, *state.columns]))
        left = problem.values - np.hstack([problem.baseline, *state.columns]) @ weights
        assert np.sqrt(np.mean(left**2)) < 0.5 * spectra.static


@measured
def test_a_kind_that_is_withheld_takes_no_part(problems):
    survey = problems[0].survey
    names = {effect.name for one in memory_sets(survey, frozenset()) for effect in one}
    assert names == {"thermal_lag", "hysteresis"}
    for withheld in names:
        sets = memory_sets(survey, frozenset({withheld}))
        assert () in sets
        assert {effect.name for one in sets for effect in one} == names - {withheld}
