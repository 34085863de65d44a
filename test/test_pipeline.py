from itertools import pairwise

import numpy as np
import pytest
from builders import LINEAR, make_calibration, make_recording
from hypothesis import given
from hypothesis import strategies as st

from hgma_compensation.channels import columns_of
from hgma_compensation.kalman.settings import FilterMode
from hgma_compensation.pipeline import pipeline as pipeline_module
from hgma_compensation.pipeline.cells import STEP
from hgma_compensation.pipeline.compensated import Compensated, joined
from hgma_compensation.pipeline.pipeline import Pipeline
from hgma_compensation.pipeline.status import TemperatureStatus
from hgma_compensation.stamps import NANOSECONDS

RECORDING = make_recording(duration_s=60.0, accel_rate=10.0, thermistor_rate=2.0, cycles=1.0)
VALUES = RECORDING.values[:, columns_of(LINEAR)]


def batch(calibration):
    pipeline = Pipeline(calibration)
    pipeline.track.extend(RECORDING.temperature.stamps, RECORDING.temperature.values)
    return pipeline.compensate(RECORDING.stamps, VALUES)


def assert_same_bits(one, other):
    for name in Compensated.FIELDS:
        assert getattr(one, name).tobytes() == getattr(other, name).tobytes(), name


@pytest.mark.parametrize("mode", list(FilterMode))
@pytest.mark.parametrize("method", ["rbf", "polynomial"])
def test_sample_by_sample_gives_the_bits_of_the_batch(mode, method):
    calibration = make_calibration(mode=mode, method=method)
    stream = Pipeline(calibration, live=True)
    waiting = list(zip(RECORDING.temperature.stamps.tolist(), RECORDING.temperature.values.tolist(), strict=True))
    parts = []
    for row, stamp in enumerate(RECORDING.stamps.tolist()):
        while waiting and waiting[0][0] <= stamp:
            stream.add_temperature(*waiting.pop(0))
        parts.append(stream.compensate(RECORDING.stamps[row : row + 1], VALUES[row : row + 1]))
    assert_same_bits(joined(parts), batch(calibration))


@given(cuts=st.lists(st.integers(0, len(VALUES)), max_size=8))
def test_any_split_into_blocks_gives_the_bits_of_the_batch(cuts):
    calibration = make_calibration(mode=FilterMode.SMOOTH)
    pipeline = Pipeline(calibration)
    pipeline.track.extend(RECORDING.temperature.stamps, RECORDING.temperature.values)
    edges = [0, *sorted(cuts), len(VALUES)]
    parts = [pipeline.compensate(RECORDING.stamps[a:b], VALUES[a:b]) for a, b in pairwise(edges)]
    assert_same_bits(joined(parts), batch(calibration))


def test_long_arrays_are_evaluated_in_chunks_with_the_same_bits(monkeypatch):
    calibration = make_calibration(mode=FilterMode.SMOOTH)
    whole = batch(calibration)
    monkeypatch.setattr(pipeline_module, "CHUNK", 7)
    assert_same_bits(batch(calibration), whole)


def test_a_thermistor_sample_late_by_less_than_the_latency_changes_nothing():
    calibration = make_calibration(latency=0.3)
    stream = Pipeline(calibration)
    waiting = list(zip(RECORDING.temperature.stamps.tolist(), RECORDING.temperature.values.tolist(), strict=True))
    stream.add_temperature(*waiting.pop(0))
    parts = []
    for row, stamp in enumerate(RECORDING.stamps.tolist()):
        while waiting and waiting[0][0] <= stamp - 0.2 * NANOSECONDS:
            stream.add_temperature(*waiting.pop(0))
        parts.append(stream.compensate(RECORDING.stamps[row : row + 1], VALUES[row : row + 1]))
    assert_same_bits(joined(parts), batch(calibration))


def test_output_is_the_input_less_the_drift_which_is_that_of_the_clamped_features_where_a_cell_begins(calibration):
    result = batch(calibration)
    clamped = calibration.calibrated_range.clamp(result.features)
    drift = np.stack([channel.drift.evaluate(clamped) for channel in calibration.channels], axis=1)
    begins = RECORDING.stamps % STEP == 0
    assert begins.sum() > 100
    np.testing.assert_array_equal(result.drift[begins], drift[begins])
    np.testing.assert_array_equal(result.values, VALUES - result.drift)
    assert not result.innovation.any()


def test_without_temperature_the_drift_at_mid_range_is_subtracted_and_said_to_be_a_guess(calibration):
    result = Pipeline(calibration).compensate(RECORDING.stamps[:3], VALUES[:3])
    middle = calibration.calibrated_range.middle[None]
    expected = [channel.drift.evaluate(middle)[0] for channel in calibration.channels]
    np.testing.assert_array_equal(result.drift, [expected] * 3)
    assert (result.status == TemperatureStatus.MISSING).all()
    assert not result.inside_range.any()
    assert np.isfinite(result.features).all()


def test_status_settles_then_is_ok_then_stale(calibration):
    pipeline = Pipeline(calibration)
    for second in range(31):
        pipeline.add_temperature(second * NANOSECONDS, 25.0)
    seconds = np.array([-1, 5, 25, 30, 45])
    result = pipeline.compensate(seconds * NANOSECONDS, np.zeros((5, 3)))
    names = [TemperatureStatus(code).name for code in result.status]
    assert names == ["MISSING", "SETTLING", "OK", "OK", "STALE"]


def test_status_settles_again_after_every_power_on(calibration):
    pipeline = Pipeline(calibration)
    for second in (*range(31), *range(100, 131)):
        pipeline.add_temperature(second * NANOSECONDS, 25.0)
    seconds = np.array([30, 70, 99, 100, 119, 121])
    result = pipeline.compensate(seconds * NANOSECONDS, np.zeros((6, 3)))
    names = [TemperatureStatus(code).name for code in result.status]
    assert names == ["OK", "STALE", "STALE", "SETTLING", "SETTLING", "OK"]


def test_outside_the_calibrated_range_the_drift_is_that_of_its_edge(calibration):
    pipeline = Pipeline(calibration)
    for second in range(60):
        pipeline.add_temperature(second * NANOSECONDS, 95.0)
    stamps = np.array([59 * NANOSECONDS])
    result = pipeline.compensate(stamps, np.zeros((1, 3)))
    edge = calibration.calibrated_range.clamp(result.features)
    assert result.features[0, 0] == pytest.approx(95.0)
    assert edge[0, 0] == calibration.calibrated_range.upper[0]
    assert result.drift[0, 0] == calibration.channels[0].drift.evaluate(edge)[0]
    assert TemperatureStatus(result.status[0]) is TemperatureStatus.OUT_OF_RANGE
    assert not result.inside_range[0]


def test_a_looping_bag_gives_the_same_output_each_time():
    pipeline = Pipeline(make_calibration(mode=FilterMode.SMOOTH), live=True)
    rounds = []
    for _ in range(3):
        for stamp, celsius in zip(RECORDING.temperature.stamps, RECORDING.temperature.values, strict=True):
            pipeline.add_temperature(int(stamp), float(celsius))
        rounds.append(pipeline.compensate(RECORDING.stamps, VALUES))
    assert_same_bits(rounds[1], rounds[0])
    assert_same_bits(rounds[2], rounds[0])


def test_reset_forgets_history_and_filter_state():
    calibration = make_calibration(mode=FilterMode.SMOOTH)
    pipeline = Pipeline(calibration)
    pipeline.add_temperature(int(RECORDING.stamps[0]), 55.0)
    pipeline.compensate(RECORDING.stamps, VALUES + 100.0)
    pipeline.reset()
    pipeline.track.extend(RECORDING.temperature.stamps, RECORDING.temperature.values)
    assert_same_bits(pipeline.compensate(RECORDING.stamps, VALUES), batch(calibration))
