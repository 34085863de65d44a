from dataclasses import replace

import numpy as np
import pytest
from report_diagnosis import CHANNEL, LAG, Checker, small_diagnosis

from hgma_compensation.effects.periodic_interference import PeriodicInterference
from hgma_compensation.effects.registry import kinds, make
from hgma_compensation.report.pictures import aligned, by_effect
from hgma_compensation.report.pictures.canvas import MOST_POINTS, Chart, cloud, line, note, thinned
from hgma_compensation.report.pictures.evidence import Evidence, evidence_of
from hgma_compensation.report.pictures.ramps import direction
from hgma_compensation.report.remainder import shares_of, two_levels
from hgma_compensation.report.words import number, probability, quantity

OTHERS = {
    "cross_axis": {"source": "linear_acceleration.y"},
    "quadratic_nonlinearity": {"channel": CHANNEL},
    "scale_factor_temperature": {"channel": CHANNEL},
    "supply_voltage": {"nominal": 5.0},
    "vibration_rectification": {"time_constant": 5.0, "floor": 0.0, "channel": CHANNEL},
}


@pytest.fixture(scope="module")
def findings():
    return small_diagnosis().channels[0].findings


def example_of(name, survey):
    if name == "periodic_interference":
        return PeriodicInterference(300.0, float(survey.origin))
    if name in OTHERS:
        return make(name, OTHERS[name])
    candidates = list(kinds()[name].candidates(replace(survey, shocks=True)))
    return candidates[len(candidates) // 2]


@pytest.mark.parametrize("name", sorted(kinds()))
def test_every_kind_of_effect_has_pictures(findings, name):
    effect = example_of(name, findings.state.problem.survey)
    state = findings.state.with_effects([effect], findings.state.problem.columns([effect]))
    _, residual = state.fit()
    evidence = Evidence(CHANNEL, state, effect, state.columns[0].sum(axis=1), residual, findings.stages)
    for picture in by_effect.PICTURES[name]:
        for chart in picture(evidence):
            text = Checker(chart.html()).text
            assert chart.title in text
            assert "nan" not in text


def test_an_effect_of_a_user_is_drawn_over_time(findings, monkeypatch):
    monkeypatch.setattr(by_effect, "PICTURES", {})
    ((_, charts),) = by_effect.evidence_charts(findings, CHANNEL)
    assert [chart.title for chart in charts] == ["Over the recordings"]


def test_partial_residual_is_residual_and_contribution(findings):
    (evidence,) = evidence_of(findings, CHANNEL)
    weights, residual = findings.state.fit()
    own = findings.state.columns[0] @ weights[findings.state.problem.baseline.shape[1] :]
    assert np.allclose(evidence.partial, residual + own)
    assert residual.std() < 0.05 * evidence.partial.std()


def test_response_to_corners_is_that_of_the_lag(findings):
    (evidence,) = evidence_of(findings, CHANNEL)
    corners = aligned.corners(evidence)
    responses = aligned.align(evidence, corners, 100.0, 200.0)
    edges = np.array([-60.0, -30.0, LAG - 10.0, LAG + 10.0, 120.0, 180.0])
    data, fitted = (responses.mean(values, edges) for values in (evidence.partial, evidence.contribution))
    assert 6 <= len(corners) <= 3 + 7  # turns of two and of four cycles
    assert np.allclose(data, fitted, atol=0.03)
    assert abs(data[0]) < 0.1 < data[2] < data[4]


def test_direction_tells_heating_from_cooling_and_soak():
    rate = np.concatenate([np.full(50, 0.03), np.full(50, -0.03), np.full(50, 0.0005)])
    assert np.array_equal(direction(rate), np.repeat([1, -1, 0], 50))


def test_many_points_are_thinned():
    assert len(thinned(10 * MOST_POINTS + 1)) <= MOST_POINTS
    assert len(thinned(MOST_POINTS)) == MOST_POINTS


def test_numbers_in_pictures_keep_their_digits():
    chart = Chart("<t>")
    cloud(chart.axes[0], np.array([0.123456, 1.0]), np.array([0.0, 0.0012345]), "heat")
    line(chart.axes[0], np.array([0.0, 1.0]), np.array([0.0, np.nan]), "fit")
    note(chart.axes[0], "0.0012345")
    drawn = chart.html()
    assert "0.0012345" in Checker(drawn).text
    assert "var(--heat)" in drawn
    assert not [word for word in ("#0102", "<t>") if word in drawn]


def test_shares_tell_offsets_from_loops(findings):
    state = findings.before
    run, way = state.problem.scene.blocks.run, direction(state.problem.features[:, 1])
    offsets = shares_of(state, np.where(run == 0, 1.0, -1.0))
    loop = shares_of(state, way.astype(float))
    assert max(offsets, key=offsets.get) == "lies in offsets between the recordings"
    assert max(loop, key=loop.get) == "goes with the direction of the ramp (a loop)"


def test_two_levels_are_told_from_noise():
    random = np.random.default_rng(1)
    assert two_levels(random.standard_normal(2000)) < 0.7
    assert two_levels(np.repeat([0.0, 1.0, 0.0], 300) + 0.05 * random.standard_normal(900)) > 0.95


@pytest.mark.parametrize(
    ("value", "written"),
    [(0.0, "0"), (1234.5, "1230"), (-0.01234, "−0.0123"), (12.0, "12.0"), (3.2e-9, "3.20·10⁻⁹"), (float("nan"), "–")],
)
def test_numbers_are_written_with_three_digits(value, written):
    assert number(value) == written


def test_accelerations_that_matter_are_given_in_g_too():
    assert quantity(98.0665, CHANNEL) == "98.1\u00a0m/s² (10.0\u00a0g)"
    assert quantity(0.01, CHANNEL) == "0.0100\u00a0m/s²"
    assert quantity(3.0, "angular_velocity.x") == "3.00\u00a0rad/s"


def test_probabilities_too_small_to_mean_anything_are_not_spelled_out():
    assert probability(0.0) == probability(1e-300) == "below 10⁻¹²"
    assert probability(0.25) == "0.25"
