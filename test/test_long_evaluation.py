"""Figures and calibrations of recordings that are not held in memory, against those of the same held."""

import allantools
import numpy as np
import pytest
from builders import LINEAR, make_calibration, make_recording
from hypothesis import given
from hypothesis import strategies as st
from test_offline_run import NAMES, write

from hgma_compensation.errors import RefusedError
from hgma_compensation.evaluation import long_evaluation
from hgma_compensation.evaluation.allan_confidence import degrees_of_freedom
from hgma_compensation.evaluation.allan_pyramid import AllanPyramid
from hgma_compensation.evaluation.evaluate import evaluate
from hgma_compensation.evaluation.evaluate_bag import evaluate_bag
from hgma_compensation.kalman.settings import FilterMode
from hgma_compensation.recording.bag_reader import read_recording
from hgma_compensation.recording.streamed import StreamedRecording, open_recording, survey
from hgma_compensation.training import filter_design
from hgma_compensation.training.blocks import GroupSums, group_means
from hgma_compensation.training.filter_design import spread_samples
from hgma_compensation.training.methods import Method
from hgma_compensation.training.reference import Reference
from hgma_compensation.training.train import TrainingOptions, train

RECORDING = make_recording(seed=3, duration_s=200.0, cycles=2.0, accel_rate=20.0, name="bag")


@given(
    index=st.lists(st.integers(0, 12), min_size=1, max_size=60),
    cuts=st.lists(st.integers(0, 60), max_size=4),
    rises=st.booleans(),
)
def test_sums_of_groups_do_not_depend_on_the_parts_that_rows_come_in(index, cuts, rises):
    index = np.array(sorted(index) if rises else index)
    columns = np.random.default_rng(len(index)).standard_normal((len(index), 2)) * 10.0 ** (index[:, None] - 6)
    sums = GroupSums(2)
    for part in np.split(np.arange(len(index)), sorted(min(cut, len(index)) for cut in cuts)):
        sums.add(index[part], columns[part])
    assert sums.means().tobytes() == group_means(index, columns).tobytes()
    expected = []
    for group in np.unique(index).tolist():
        total = 0.0
        for value in columns[index == group, 0].tolist():
            total += value
        expected.append(total / np.count_nonzero(index == group))
    assert group_means(index, columns)[:, 0].tolist() == expected


def series(kind, count):
    random = np.random.default_rng(20190218)
    white = random.standard_normal(count)
    walk = 0.02 * np.cumsum(random.standard_normal(count))
    return {"white": white, "white and walk": white + walk, "walk far from zero": 1e6 + walk}[kind]


@pytest.mark.parametrize("kind", ["white", "white and walk", "walk far from zero"])
@pytest.mark.parametrize("part", [1000, 65536])
def test_the_pyramid_agrees_with_allantools(kind, part):
    values = series(kind, 200_000)
    pyramid = AllanPyramid(2)
    for start in range(0, len(values), part):
        pyramid.add(np.stack([values[start : start + part]] * 2, axis=1))
    factors, deviations = pyramid.deviations(len(values) // 8)
    _, expected, _, _ = allantools.oadev(values, rate=1.0, data_type="freq", taus=factors.astype(float))
    assert pyramid.samples == len(values)
    assert factors[-1] > len(values) // 16
    assert (deviations[:, 0] == deviations[:, 1]).all()
    exact = factors <= 11
    np.testing.assert_allclose(deviations[exact, 0], expected[exact], rtol=1e-6)
    for factor, one, other in zip(factors[~exact], deviations[~exact, 0], expected[~exact], strict=True):
        # Half the standard deviation of the estimate itself: the same data, in steps of an eighth.
        freedom = degrees_of_freedom(-0.5 if kind == "white" else 0.5, int(factor), len(values))
        assert one == pytest.approx(other, rel=0.5 / np.sqrt(2.0 * freedom))


@pytest.mark.parametrize("span", [(None, None), (20.0, 120.0), (33.3, None), (None, 77.7)])
@pytest.mark.parametrize("block", [1, 37])
def test_a_bag_is_evaluated_as_its_recording(tmp_path, block, span):
    write(tmp_path / "bag", RECORDING, block=block)
    calibration = make_calibration(mode=FilterMode.SMOOTH)
    expected = evaluate(read_recording(tmp_path / "bag").cut(*span), calibration, Reference())
    result = evaluate_bag(tmp_path / "bag", calibration, Reference(), names=NAMES, span=span)
    assert result.as_json() == expected.as_json()
    for one, other in zip(result.channels, expected.channels, strict=True):
        assert one.compensated_error.tobytes() == other.compensated_error.tobytes()
        assert one.temperature.tobytes() == other.temperature.tobytes()


@pytest.mark.parametrize("reference", ["mean", "9.81"])
def test_figures_of_what_is_not_held_are_those_of_what_is(tmp_path, monkeypatch, reference):
    write(tmp_path / "bag", RECORDING)
    calibration = make_calibration()
    expected = evaluate(RECORDING, calibration, Reference.parse(reference))
    monkeypatch.setattr(long_evaluation, "WHOLE", 700)
    monkeypatch.setattr(long_evaluation, "AT_ONCE", 500)
    monkeypatch.setattr("hgma_compensation.recording.look_ahead.LONGEST", 7 * 10**9)
    result = evaluate_bag(tmp_path / "bag", calibration, Reference.parse(reference), names=NAMES)
    for one, other in zip(result.channels, expected.channels, strict=True):
        for name in ("raw", "compensated"):
            a, b = getattr(one, name), getattr(other, name)
            assert a.samples == b.samples
            assert a.rms_error == pytest.approx(b.rms_error, rel=1e-12)
            assert a.span == pytest.approx(b.span, rel=1e-12)
            assert a.velocity_random_walk == pytest.approx(b.velocity_random_walk, rel=1e-9)
            assert a.bias_instability == pytest.approx(b.bias_instability, rel=0.1)
        assert one.noise_floor == other.noise_floor
        assert one.time.tobytes() == other.time.tobytes()


def test_a_part_without_samples_is_refused_as_of_a_recording(tmp_path):
    write(tmp_path / "bag", RECORDING)
    for read in (
        lambda: evaluate_bag(tmp_path / "bag", make_calibration(), Reference(), names=NAMES, span=(900.0, None)),
        lambda: survey(tmp_path / "bag", NAMES).cut(900.0, None),
        lambda: RECORDING.cut(900.0, None),
    ):
        with pytest.raises(RefusedError, match=r"bag has no sample from 900 s until its end: it lasts 199\.9 s|made"):
            read()


OPTIONS = TrainingOptions(
    method=Method.POLYNOMIAL, filter=FilterMode.SMOOTH, filter_time_constant=5.0, delay=10.0, block=2.0
)


@pytest.mark.parametrize("span", [(None, None), (30.0, 150.0)])
@pytest.mark.parametrize("block", [1, 37])
def test_a_recording_left_in_its_bag_gives_the_same_calibration(tmp_path, monkeypatch, block, span):
    monkeypatch.setattr("hgma_compensation.recording.message_batches.BATCH", 9000)
    monkeypatch.setattr("hgma_compensation.recording.mcap_bulk_writer.CHUNK", 9000)
    write(tmp_path / "bag", RECORDING, block=block)
    left, held = open_recording(tmp_path / "bag", NAMES, None), read_recording(tmp_path / "bag")
    assert isinstance(left, StreamedRecording)
    left, held = left.cut(*span), held.cut(*span)
    assert len(list(left.windows())) > 3
    for name in ("name", "frame", "present", "start", "duration", "samples"):
        assert getattr(left, name) == getattr(held, name), name
    assert left.temperature.values.tobytes() == held.temperature.values.tobytes()
    one, other = train([left], OPTIONS), train([held], OPTIONS)
    assert one.calibration_id == other.calibration_id


@pytest.mark.parametrize("most", [1, 2**20])
def test_the_noise_of_a_long_recording_is_told_from_evenly_spread_stretches(monkeypatch, most):
    monkeypatch.setattr(filter_design, "MOST_SAMPLES", most)
    monkeypatch.setattr(filter_design, "STRETCHES", 4)
    monkeypatch.setattr(filter_design, "STRETCH", 256)
    stamps, values = spread_samples(RECORDING, LINEAR[1:])
    rows = np.arange(4000)
    if most == 1:
        rows = rows[rows % 1000 < 256]
    np.testing.assert_array_equal(stamps, RECORDING.stamps[rows])
    np.testing.assert_array_equal(values, RECORDING.values[rows, 1:3])
