"""What a fleet is made of: folders, hold-outs, figures, limits, outliers."""

import json
from pathlib import Path

import jsonschema
import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st
from refusals import refusal_of

from hgma_compensation.evaluation.evaluate import ChannelEvaluation, Measures
from hgma_compensation.fleet.figures import BY_NAME, FIGURES, Worse, figures_of, slope
from hgma_compensation.fleet.limits import Limits, keeps, read_limits
from hgma_compensation.fleet.outliers import outlying, robust_scores
from hgma_compensation.fleet.sensors import holdout_of, recordings_of, sensor_names
from hgma_compensation.schema_check import load_schema

ROOT = Path(__file__).parents[1]
Z = "linear_acceleration.z"
SCHEMA = load_schema("hgma_compensation.fleet", "acceptance.schema.json")


def named(*names):
    return tuple(Path(name) for name in names)


def test_sensors_are_the_folders_that_are_not_hidden(tmp_path):
    for name in ("b", "a", ".git"):
        (tmp_path / name).mkdir()
    (tmp_path / "notes.txt").touch()
    assert sensor_names(tmp_path) == ("a", "b")


def test_folders_that_hold_no_fleet_are_refused(tmp_path):
    assert "holds no folder" in refusal_of(sensor_names, tmp_path)
    assert "is no directory" in refusal_of(sensor_names, tmp_path / "absent")
    (tmp_path / ("n" * 201)).mkdir()
    assert "more than 200 characters: rename it" in refusal_of(sensor_names, tmp_path)
    (tmp_path / "line\nbreak").mkdir()
    assert "rename it" in refusal_of(sensor_names, tmp_path)
    (tmp_path / "metadata.yaml").touch()
    assert "is itself a recording" in refusal_of(sensor_names, tmp_path)


def test_recordings_are_bags_of_any_form_and_a_folder_that_lacks_its_metadata(tmp_path):
    for folder in ("whole", "cut_off", "photographs"):
        (tmp_path / folder).mkdir()
    for file in ("whole/metadata.yaml", "cut_off/cut_off_0.mcap", "photographs/oven.png", "c.mcap", "a.db3", "x.csv"):
        (tmp_path / file).touch()
    assert [path.name for path in recordings_of(tmp_path)] == ["a.db3", "c.mcap", "cut_off", "whole"]
    assert recordings_of(tmp_path / "whole") == (tmp_path / "whole",)
    assert "hgma import-csv" in refusal_of(recordings_of, tmp_path / "photographs")
    assert "cannot be read" in refusal_of(recordings_of, tmp_path / "absent")


@pytest.mark.parametrize(
    ("names", "pattern", "chosen"),
    [
        (("train", "holdout"), None, "holdout"),
        (("Acceptance.mcap", "oven.mcap"), None, "Acceptance.mcap"),
        (("a", "b"), None, None),
        (("a.mcap", "b.mcap"), "b", "b.mcap"),
        (("holdout", "second_oven"), "second*", "second_oven"),
    ],
)
def test_a_recording_is_held_out_by_its_name(names, pattern, chosen):
    assert holdout_of(named(*names), pattern) == (None if chosen is None else Path(chosen))


def test_a_hold_out_that_is_none_or_several_or_all_is_refused():
    assert "change --holdout" in refusal_of(holdout_of, named("a", "b"), "c")
    assert "a, accept" not in refusal_of(holdout_of, named("a", "accept", "holdout"), None)
    assert "accept, holdout are all" in refusal_of(holdout_of, named("a", "accept", "holdout"), None)
    assert "only recording" in refusal_of(holdout_of, named("holdout"), None)


def evaluation(raw, residual, temperature):
    def measures(error):
        return Measures(float(np.sqrt(np.mean(error**2))), float(np.ptp(error)), 0.5, 0.25, 10 * len(error))

    time = 5.0 * np.arange(len(raw))
    return ChannelEvaluation(Z, measures(raw), measures(residual), 0.1, time, temperature, raw, residual)


def test_figures_are_what_they_are_called():
    temperature = np.linspace(-10.0, 60.0, 200)
    raw = 3.0 + 2.0 * temperature
    residual = 0.7 + 0.01 * (temperature - 25.0)
    figures = figures_of(evaluation(raw, residual, temperature))
    assert figures["raw_span"] == pytest.approx(140.0)
    assert figures["raw_temperature_sensitivity"] == pytest.approx(2.0)
    assert figures["temperature_sensitivity"] == pytest.approx(0.01)
    assert figures["residual_mean"] == pytest.approx(0.7)
    assert figures["residual_standard_deviation"] == pytest.approx(np.std(residual))
    assert figures["residual_peak_to_peak"] == pytest.approx(0.7)
    assert figures["velocity_random_walk"] == 0.5
    assert figures["bias_instability"] == 0.25
    # The definition of the coefficient of determination, from drift and prediction instead of their difference.
    drift, predicted = raw, raw - residual
    expected = 1.0 - np.sum((drift - predicted) ** 2) / np.sum((drift - drift.mean()) ** 2)
    assert figures["r_squared"] == pytest.approx(expected)
    assert set(figures) == set(BY_NAME)


def test_a_figure_that_is_not_defined_is_none():
    steady = np.full(20, 25.0)
    figures = figures_of(evaluation(np.zeros(20), np.zeros(20), steady))
    assert figures["temperature_sensitivity"] is None
    assert figures["r_squared"] is None
    assert slope(steady, np.arange(20.0)) is None
    broken = Limits({Z: {"r_squared": 0.9}}).broken({Z: figures})
    assert "is not defined" in str(broken[0])


@given(st.floats(-100.0, 100.0), st.floats(-50.0, 50.0), st.integers(3, 60))
def test_the_slope_is_that_of_numpy(gain, offset, count):
    temperature = np.linspace(-10.0, 60.0, count)
    values = offset + gain * temperature + np.sin(np.arange(count))
    assert slope(temperature, values) == pytest.approx(np.polyfit(temperature, values, 1)[0], rel=1e-6, abs=1e-9)


def test_limits_are_kept_on_the_side_that_matters():
    assert keeps("residual_mean", -1.0, 1.0)
    assert not keeps("residual_mean", -1.1, 1.0)
    assert keeps("raw_span", 1.0, 1.0)
    assert not keeps("raw_span", 1.1, 1.0)
    assert keeps("r_squared", 0.99, 0.99)
    assert not keeps("r_squared", 0.98, 0.99)
    assert not keeps("r_squared", None, 0.99)


def test_a_channel_goes_before_its_group():
    limits = Limits({"linear_acceleration": {"raw_span": 5.0, "r_squared": 0.9}, Z: {"raw_span": 7.0}})
    assert limits.of(Z) == {"raw_span": 7.0, "r_squared": 0.9}
    assert limits.of("linear_acceleration.x") == {"raw_span": 5.0, "r_squared": 0.9}
    assert limits.of("angular_velocity.x") == {}


def test_the_example_of_limits_is_one():
    limits = read_limits(ROOT / "params" / "acceptance.yaml")
    assert set(limits.of(Z)) == set(BY_NAME)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("acceptance: 1\nlinear_acceleration: {rms: 1.0}", "linear_acceleration has the unknown field 'rms'"),
        ("acceptance: 1\nlinear_acceleration.w: {raw_span: 1.0}", "unknown field 'linear_acceleration.w'"),
        ("acceptance: 1\nlinear_acceleration: {raw_span: -1.0}", "linear_acceleration.raw_span is -1.0"),
        ("acceptance: 1\nlinear_acceleration: {raw_span: wide}", "must be a number"),
        ("acceptance: 1\nlinear_acceleration: {r_squared: 99.0}", "must be at most"),
        ("acceptance: 1\nlinear_acceleration: {raw_span: .nan}", "not finite"),
        ("acceptance: 2\nlinear_acceleration: {raw_span: 1.0}", "acceptance is 2"),
        ("linear_acceleration: {raw_span: 1.0}", "lacks the field 'acceptance'"),
        ("acceptance: 1", "sets no limit"),
        ("acceptance: 1\nlinear_acceleration: {}", "sets no limit"),
        ("- 1", "must be an object"),
        ("a: [", "no YAML"),
        ("", "must be an object"),
    ],
)
def test_limits_that_are_none_are_refused(tmp_path, text, words):
    path = tmp_path / "limits.yaml"
    path.write_text(text)
    refusal = refusal_of(read_limits, path)
    assert words in refusal
    assert str(path) in refusal


def test_limits_that_cannot_be_read_are_refused_in_one_sentence(tmp_path):
    refusal = refusal_of(read_limits, tmp_path / "absent.yaml")
    assert refusal.count("absent.yaml") == 1


@given(
    st.dictionaries(
        st.sampled_from(["linear_acceleration", Z, "angular_velocity", "elsewhere"]),
        st.dictionaries(
            st.sampled_from([*BY_NAME, "rms"]),
            st.one_of(st.floats(-1.0, 3.0), st.just("text"), st.none(), st.booleans()),
            max_size=3,
        ),
        max_size=3,
    )
)
def test_limits_are_read_as_their_schema_says(tmp_path_factory, sections):
    path = tmp_path_factory.mktemp("limits") / "limits.yaml"
    document = {"acceptance": 1, **sections}
    path.write_text(yaml.safe_dump(document))
    valid = jsonschema.Draft202012Validator(SCHEMA).is_valid(document) and any(sections.values())
    assert (refusal_of(read_limits, path) is None) == valid


def test_the_schema_has_the_figures():
    assert set(SCHEMA["$defs"]["limits"]["properties"]) == {figure.name for figure in FIGURES}
    assert json.dumps(SCHEMA)


def test_the_score_is_that_of_iglewicz_and_hoaglin():
    values = np.array([2.1, 2.6, 2.4, 2.5, 2.3, 2.1, 2.3, 2.6, 8.2, 8.3])
    scores = robust_scores(values)
    assert scores == pytest.approx(0.6745 * (values - 2.45) / 0.15)  # median and median deviation by hand
    assert np.flatnonzero(outlying(scores, Worse.UP)).tolist() == [8, 9]
    assert not outlying(scores, Worse.DOWN).any()
    assert np.flatnonzero(outlying(-scores, Worse.AWAY)).tolist() == [8, 9]


def test_few_sensors_or_equal_ones_have_no_outlier():
    assert not outlying(robust_scores(np.array([1.0] * 3 + [99.0])), Worse.AWAY).any()
    assert not outlying(robust_scores(np.array([1.0] * 20 + [99.0])), Worse.AWAY).any()


@given(st.lists(st.floats(-1e6, 1e6), min_size=8, max_size=40), st.floats(0.5, 100.0), st.floats(-1e3, 1e3))
def test_scores_do_not_depend_on_the_unit(values, factor, offset):
    plain = robust_scores(np.array(values))
    other = robust_scores(factor * np.array(values) + offset)
    if np.isfinite(plain).all() and np.median(np.abs(values - np.median(values))) > 1e-3:
        assert other == pytest.approx(plain, rel=1e-3, abs=1e-3)
