import json
from dataclasses import replace

import numpy as np
import pytest
from builders import LINEAR, make_calibration, make_recording, make_stamps

from hgma_compensation.channels import columns_of
from hgma_compensation.errors import RefusedError
from hgma_compensation.evaluation.allan import FLICKER_FLOOR, allan_curve, bias_instability, velocity_random_walk
from hgma_compensation.evaluation.evaluate import compare, evaluate
from hgma_compensation.evaluation.evaluate_bag import evaluate_bag
from hgma_compensation.recording.bag_writer import write_recording
from hgma_compensation.topics import TopicNames
from hgma_compensation.training.methods import Method
from hgma_compensation.training.reference import Reference
from hgma_compensation.training.train import TrainingOptions, train

RECORDING = make_recording(seed=3, duration_s=400.0, cycles=4.0)


def test_random_walk_and_bias_instability_of_white_noise():
    rate, density = 100.0, 0.02
    white = density * np.sqrt(rate) * np.random.default_rng(5).standard_normal(200_000)
    curve = allan_curve(make_stamps(np.arange(len(white)) / rate), white)
    # N is read at the shortest τ, whose deviation has a relative standard error of 1 / sqrt(2 (n - 1)).
    assert velocity_random_walk(curve) == pytest.approx(density, rel=4.0 / np.sqrt(2.0 * len(white)))
    assert bias_instability(curve) == pytest.approx(curve.deviations.min() / 0.6642824702679600)
    assert pytest.approx(0.6642824702679600) == FLICKER_FLOOR


def test_too_few_samples_have_no_allan_deviation():
    assert allan_curve(make_stamps(np.arange(50.0)), np.zeros(50)) is None


def test_error_and_span_are_those_of_means_over_five_seconds():
    stamps = make_stamps(np.arange(200) / 20.0)
    raw = np.r_[np.full(100, 1.0), np.full(100, 4.0)] + np.tile([0.5, -0.5], 100)
    calibration = make_calibration(channels=("linear_acceleration.z",))
    zeros = np.zeros((200, 1))
    result = compare(stamps, raw[:, None], zeros, zeros[:, 0], calibration, Reference((1.0,))).channels[0]
    assert result.raw.rms_error == pytest.approx(np.sqrt((0.0 + 9.0) / 2.0))
    assert result.raw.span == pytest.approx(3.0)
    assert result.compensated.rms_error == pytest.approx(1.0)
    assert result.raw.samples == 200


def test_with_the_mean_as_reference_only_drift_counts():
    stamps = make_stamps(np.arange(200) / 20.0)
    values = np.full((200, 1), 7.0)
    calibration = make_calibration(channels=("linear_acceleration.z",))
    result = compare(stamps, values, values + 3.0, values[:, 0], calibration, Reference()).channels[0]
    assert result.raw.rms_error == result.compensated.rms_error == pytest.approx(0.0, abs=1e-12)


def test_a_calibration_trained_on_one_recording_removes_the_drift_of_another():
    options = TrainingOptions(method=Method.POLYNOMIAL_RATE, reference=Reference((9.81,)), delay=10.0)
    calibration = train([make_recording(seed=2, duration_s=400.0, cycles=2.0)], options)
    figures = evaluate(RECORDING, calibration, Reference((9.81,))).as_json()
    assert figures["calibration_id"] == calibration.calibration_id
    assert list(figures["channels"]) == list(LINEAR)
    keys = {"rms_error", "span", "velocity_random_walk", "bias_instability", "samples"}
    for channel in figures["channels"].values():
        assert channel["unit"] == "m/s^2"
        assert set(channel["raw"]) == set(channel["compensated"]) == keys
        # The drift is no polynomial: a cubic leaves what its Taylor series leaves, some percent.
        assert channel["compensated"]["rms_error"] < 0.1 * channel["raw"]["rms_error"]
    json.dumps(figures, allow_nan=False)


def test_a_recording_without_a_calibrated_channel_is_refused():
    only_z = make_recording(duration_s=20.0, channels=("linear_acceleration.z",))
    with pytest.raises(RefusedError, match=r"has no channel linear_acceleration\.x, linear_acceleration\.y"):
        evaluate(only_z, make_calibration(), Reference())


def test_samples_that_are_not_finite_do_not_count():
    values = RECORDING.values.copy()
    values[10, columns_of(LINEAR)[0]] = np.nan
    broken = type(RECORDING)(**{**RECORDING.__dict__, "values": values})
    result = evaluate(broken, make_calibration(), Reference())
    assert {channel.raw.samples for channel in result.channels} == {len(RECORDING.stamps) - 1}
    assert all(np.isfinite(channel.raw.rms_error) for channel in result.channels)


def test_a_recording_without_a_finite_sample_is_refused_with_the_channels_and_a_remedy(tmp_path):
    recording = make_recording(duration_s=100.0)
    broken = replace(recording, values=np.full_like(recording.values, np.nan))
    write_recording(broken, tmp_path / "bag")
    with pytest.raises(RefusedError, match=r"linear_acceleration\.z.*train with the --channels"):
        evaluate_bag(tmp_path / "bag", make_calibration(), Reference.parse("mean"), names=TopicNames())
