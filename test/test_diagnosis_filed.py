"""A diagnosis of samples that wait in files is that of samples in memory, to the bit."""

import json
from dataclasses import replace

import numpy as np
import pytest
from builders import LINEAR, make_calibration, make_recording
from diagnosis_blocks import CHANNEL, NOISE, diagnosis_of_days, lagging_days, trained_before
from hypothesis import given
from hypothesis import strategies as st

from hgma_compensation.diagnosis import blocks as blocks_module
from hgma_compensation.diagnosis.blocks import Blocks, make_blocks
from hgma_compensation.diagnosis.diagnose import diagnose
from hgma_compensation.diagnosis.held_samples import HeldSamples
from hgma_compensation.diagnosis.medians import median_of
from hgma_compensation.diagnosis.noise_model import NoiseModel
from hgma_compensation.diagnosis.prepare import _noise
from hgma_compensation.diagnosis.recordings import arrange
from hgma_compensation.diagnosis.runs import make_run
from hgma_compensation.recording.bag_reader import read_recording
from hgma_compensation.recording.bag_writer import write_recording
from hgma_compensation.recording.compensated_bag import usable_rows
from hgma_compensation.recording.filed import FiledRecording, file_recording
from hgma_compensation.recording.spooled import Spooled
from hgma_compensation.stamps import NANOSECONDS

SERIES = ("temperature", "temperature_2", "supply_voltage")


def damaged(duration=300.0, name="damaged"):
    """Return a recording with samples that have no value, and shocks."""
    made = make_recording(3, duration, 20.0, 1.0, channels=LINEAR, name=name)
    values = made.values.copy()
    values[200:205, 0] = np.nan
    values[1000, 2] = np.nan
    values[3000:3003, 2] += 5000.0
    return replace(made, values=values)


@pytest.mark.parametrize("block", [1, 50])
def test_a_recording_in_files_is_that_in_memory(tmp_path, block):
    write_recording(damaged(), tmp_path / "bag", block=block)
    held, filed = read_recording(tmp_path / "bag"), file_recording(tmp_path / "bag")
    assert isinstance(filed, FiledRecording)
    for name in ("stamps", "values"):
        assert getattr(filed, name)[:].tobytes() == getattr(held, name).tobytes()
        assert getattr(filed, name)[-7:-2].tobytes() == getattr(held, name)[-7:-2].tobytes()
        assert len(getattr(filed, name)[5:5]) == 0
    for name in ("name", "present", "frame", "start", "duration", "samples", "first", "last"):
        assert getattr(filed, name) == getattr(held, name)
    for name in SERIES:
        assert getattr(filed, name).values.tobytes() == getattr(held, name).values.tobytes()
        assert filed.has(name) == held.has(name)
    assert (filed.block is None) == (held.block is None) == (block == 1)
    if block > 1:
        np.testing.assert_array_equal(filed.block[:], held.block)
    windows = list(filed.windows())
    assert np.concatenate([values for _, values in windows]).tobytes() == held.values.tobytes()
    calibration = make_calibration(3)
    usable = usable_rows(filed, calibration)
    np.testing.assert_array_equal(usable, usable_rows(held, calibration))
    assert np.count_nonzero(~usable) == (6 if block == 1 else 100)


@given(most=st.integers(1, 700), seconds=st.floats(0.3, 40.0))
def test_means_over_blocks_do_not_depend_on_how_many_samples_are_read_at_once(most, seconds):
    recording = damaged(60.0)
    runs = [make_run(recording, NOISE)]
    whole = make_blocks(runs, CHANNEL, seconds)
    before, blocks_module.MOST_AT_ONCE = blocks_module.MOST_AT_ONCE, most
    try:
        parts = make_blocks(runs, CHANNEL, seconds)
    finally:
        blocks_module.MOST_AT_ONCE = before
    for name in Blocks.__dataclass_fields__:
        assert getattr(parts, name).tobytes() == getattr(whole, name).tobytes()


def split(values, cuts):
    return np.split(values, sorted(min(cut, len(values)) for cut in cuts))


CUTS = st.lists(st.integers(0, 60), max_size=5)


@given(values=st.lists(st.floats(0.0, 1e300, allow_subnormal=True), min_size=1, max_size=60), cuts=CUTS)
def test_the_median_of_parts_is_that_of_all(values, cuts):
    values = np.array(values)
    assert median_of(lambda: iter(split(values, cuts))) == np.median(values)


@given(values=st.lists(st.integers(-(10**15), 10**15), min_size=1, max_size=60), cuts=CUTS)
def test_so_is_that_of_whole_numbers(values, cuts):
    values = np.array(values)
    assert median_of(lambda: iter(split(values, cuts))) == np.median(values)


def test_the_median_of_what_is_not_known_is_not_known():
    assert np.isnan(median_of(lambda: iter([np.array([1.0, np.nan]), np.ones(3)])))
    assert np.isnan(median_of(lambda: iter([])))


@given(
    known=st.lists(st.booleans(), min_size=1, max_size=60).filter(any),
    cuts=CUTS,
    most=st.integers(1, 70),
    at_once=st.integers(1, 9),
)
def test_means_of_the_hold_out_are_those_of_all_samples_at_once(known, cuts, most, at_once):
    from hgma_compensation.recording import spooled

    count, known = len(known), np.array(known)
    random = np.random.default_rng(count)
    values = np.where(known, random.standard_normal(count), np.nan)
    stamps = np.cumsum(random.integers(1, 10, count)) * NANOSECONDS
    before, spooled.AT_ONCE = spooled.AT_ONCE, at_once
    try:
        samples = HeldSamples(zip(split(stamps, cuts), split(values, cuts), strict=True))
        size, means = samples.means(most)
    finally:
        spooled.AT_ONCE = before
    index = np.arange(count)
    filled = np.interp(index, index[known], values[known])
    assert size == -(-count // most)
    assert means.tobytes() == filled[: count // size * size].reshape(-1, size).mean(axis=1).tobytes()
    assert samples.known == known.mean()
    assert samples.interval == (np.median(np.diff(stamps)) * 1e-9 if count > 1 else 0.0)
    assert samples.values().tobytes() == values.tobytes()


def test_a_whitener_that_was_put_away_gives_the_same_bits():
    random = np.random.default_rng(1)
    run, stamps = np.repeat([0, 1], [150, 90]), np.arange(240) * 5 * NANOSECONDS
    model = NoiseModel(np.ones(240), 0.3, np.full(240, 0.1), np.array([1.0, 0.4, 0.0]), 5.0)
    columns = random.standard_normal((240, 3))
    whitener = model.whitener(run, stamps, columns)
    white, determinant = whitener(columns), whitener.log_determinant
    whitener.put_away()
    whitener.put_away()
    assert whitener(columns).tobytes() == white.tobytes()
    assert whitener.log_determinant == determinant


def test_a_covariance_formed_some_rows_at_a_time_is_that_formed_at_once():
    run, stamps = np.repeat([0, 1], [300, 140]), np.arange(440) * 5 * NANOSECONDS
    model = NoiseModel(np.ones(440), 0.3, np.full(440, 0.1), np.array([1.0, 0.4, 0.0]), 5.0)
    at_once, in_rows = model.whitener_of(model.correlated(run, stamps)), model.whitener(run, stamps)
    for one, other in zip(at_once.factors, in_rows.factors, strict=True):
        assert np.tril(one).tobytes() == np.tril(other).tobytes()


@pytest.mark.parametrize("blocks", [(1, 50), (50, 1), (50, 20)])
def test_blocks_of_joined_recordings_stay_apart(tmp_path, blocks):
    first = damaged(name="first")
    shift = 310 * NANOSECONDS
    moved = {name: replace(getattr(first, name), stamps=getattr(first, name).stamps + shift) for name in SERIES}
    second = replace(first, name="second", stamps=first.stamps + shift, **moved)
    for recording, block in zip((first, second), blocks, strict=True):
        write_recording(recording, tmp_path / recording.name, block=block)
    bags = [file_recording(tmp_path / name) for name in ("first", "second")]
    (joined,) = arrange([bags[0]], bags[1]).recordings
    assert joined.samples == len(joined.block) == 2 * len(first.stamps)
    assert np.all(np.diff(joined.block[:]) >= 0)
    each = [usable_rows(bag, make_calibration(3)) for bag in bags]
    np.testing.assert_array_equal(usable_rows(joined, make_calibration(3)), np.concatenate(each))


def test_a_diagnosis_of_recordings_in_files_is_that_of_those_in_memory(tmp_path):
    for day in lagging_days():
        write_recording(day, tmp_path / day.name)
    filed = [file_recording(tmp_path / day.name) for day in lagging_days()]
    result, expected = diagnose(filed[:2], trained_before(), filed[2]), diagnosis_of_days()
    assert json.dumps(result.as_json("")) == json.dumps(expected.as_json(""))
    assert result.calibration.calibration_id == expected.calibration.calibration_id


def test_a_sample_that_is_no_number_does_not_hide_the_noise():
    values = np.random.default_rng(2).normal(size=(5000, 6))
    clean, holed = Spooled(6), Spooled(6)
    clean.add(values)
    values[1000, 2] = np.nan
    holed.add(values)
    assert _noise(holed, 2) == pytest.approx(_noise(clean, 2), rel=0.01)
    assert _noise(Spooled(6), 2) == 0.0
