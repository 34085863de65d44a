"""The Kalman stage over many samples at once: the same as one by one, and as the formulas of the paper."""

import pickle
import platform
import subprocess
import sys
from copy import deepcopy
from itertools import pairwise

import numpy as np
import pytest
import sequential_kalman
from hypothesis import example, given, settings
from hypothesis import strategies as st
from kalman_streams import CLOCKS, EPOCH, REFERENCE, ROUNDED_CLOCKS, WHITE, Stream, clock, streams

from hgma_compensation.kalman import low_pass as low_passes
from hgma_compensation.kalman.course import course, filter_samples
from hgma_compensation.kalman.gate import InnovationGate
from hgma_compensation.kalman.intervals import PAUSE, ROUNDING, Intervals, Steps
from hgma_compensation.kalman.low_pass import NOTHING, load_compiled, low_pass, low_pass_step
from hgma_compensation.kalman.random_walk import RandomWalkFilter, RandomWalkNoise
from hgma_compensation.kalman.settings import FilterMode, FilterSettings
from hgma_compensation.kalman.stage import KalmanStage

SMOOTH = FilterSettings(FilterMode.SMOOTH, RandomWalkNoise.with_time_constant(WHITE, 0.005))
BETWEEN = ("nothing", "reset", "set back", "copy", "pickle")


def seen(stage):
    """What a caller can see of a stage."""
    counted = stage.take_consistency()
    return stage.open, stage.openings, counted.squares, counted.closed, counted.open


def run(stage, stream: Stream, acts, length):
    """Give the parts between acts in calls of some length; return results and what was seen after each part."""
    outputs, innovations, views, back = [], [], [], 0
    edges = [0, *sorted(at for at, _ in acts), len(stream.stamps)]
    kinds = ["nothing", *(kind for _, kind in sorted(acts))]
    for (start, end), kind in zip(pairwise(edges), kinds, strict=True):
        if kind == "reset":
            stage.reset()
        elif kind == "set back" and start < len(stream.stamps):
            back += 1_000_000_007
            stage.set_back(int(stream.stamps[start]) - back)
        elif kind in ("copy", "pickle"):
            stage = deepcopy(stage) if kind == "copy" else pickle.loads(pickle.dumps(stage))
        for first in range(start, end, length):
            rows = slice(first, min(first + length, end))
            out, innovation = stage.run(stream.stamps[rows] - back, stream.values[rows])
            outputs.append(out)
            innovations.append(innovation)
        views.append(seen(stage))
    return np.concatenate(outputs), np.concatenate(innovations), views


@settings(deadline=None, max_examples=150)
@given(
    streams(),
    st.lists(st.tuples(st.integers(0, 4000), st.sampled_from(BETWEEN)), max_size=6),
    st.sampled_from([5, 31, 32, 33, 100, 1000, 4000]),
)
def test_however_the_samples_are_split_no_bit_differs(stream, acts, length):
    acts = [(min(at, len(stream.stamps)), kind) for at, kind in acts]
    outputs, innovations, views = run(KalmanStage(stream.settings, REFERENCE), stream, acts, length)
    one_by_one = run(KalmanStage(stream.settings, REFERENCE), stream, acts, 1)
    assert outputs.tobytes() == one_by_one[0].tobytes()
    assert innovations.tobytes() == one_by_one[1].tobytes()
    assert views == one_by_one[2]


def long_stream(kind: str, mode: FilterMode, event: str) -> Stream:
    """6000 samples; in the first 3900 the filter settles, then something happens."""
    random = np.random.default_rng(17)
    deviation = WHITE / np.sqrt(333_300e-9)
    shown = random.standard_normal(6000)
    if event == "shock":
        shown[3900:3920] += 100.0
    else:
        shown[3900:] += 50.0
    noise = RandomWalkNoise.with_time_constant(WHITE, 0.02)
    return Stream(clock(kind, 6000, random), REFERENCE + deviation * shown, FilterSettings(mode, noise), deviation)


@pytest.mark.parametrize("kind", ["even", "jittered"])
@pytest.mark.parametrize("mode", [FilterMode.SMOOTH, FilterMode.BIAS])
@pytest.mark.parametrize("event", ["shock", "step"])
def test_in_one_call_the_gate_opens_pays_back_and_closes_as_it_does_one_by_one(kind, mode, event):
    stream = long_stream(kind, mode, event)
    stage = KalmanStage(stream.settings, REFERENCE)
    outputs, innovations, views = run(stage, stream, [], 6000)
    one_by_one = run(KalmanStage(stream.settings, REFERENCE), stream, [], 1)
    assert stage.openings == 1
    assert stage.open == (event == "step" and mode is FilterMode.BIAS)
    assert (outputs.tobytes(), innovations.tobytes()) == (one_by_one[0].tobytes(), one_by_one[1].tobytes())
    assert views == one_by_one[2]


@given(st.integers(0, 2**32 - 1), st.lists(st.integers(0, 400), max_size=3), st.booleans(), st.sampled_from([0.0, 1.0]))
def test_the_gate_takes_many_innovations_as_one_by_one(seed, cuts, constant, wander):
    random = np.random.default_rng(seed)
    normalised, variances = 1.2 * random.standard_normal(400), random.uniform(0.5, 2.0, 400)
    many, single = InnovationGate(3.0, wander), InnovationGate(3.0, wander)
    for rows in np.split(np.arange(400), sorted(cuts)):
        variance = 0.7 if constant else variances[rows]
        count = many.take_until_exceeded(normalised[rows], variance)
        each = np.broadcast_to(variance, rows.shape).tolist()
        for value, own in zip(normalised[rows][:count].tolist(), each[:count], strict=True):
            assert not single.exceeded(value, own)
        assert many._delayed == single._delayed
        if count < len(rows):
            assert single.exceeded(float(normalised[rows][count]), each[count])
            break


@settings(deadline=None, max_examples=150)
@given(streams(tuple(kind for kind in CLOCKS if kind not in ROUNDED_CLOCKS)), st.integers(1, 2000))
def test_it_is_the_stage_step_by_step_as_the_paper_writes_it(stream, length):
    stage = KalmanStage(stream.settings, REFERENCE)
    paper = sequential_kalman.KalmanStage(stream.settings, REFERENCE)
    for start in range(0, len(stream.stamps), length):
        rows = slice(start, start + length)
        outputs, innovations = stage.run(stream.stamps[rows], stream.values[rows])
        expected, expected_innovations = paper.run(stream.stamps[rows], stream.values[rows])
        scale = 1e-9 * stream.deviation + 1e-15 * np.abs(stream.values[rows])
        assert (np.abs(outputs - expected) <= scale).all()
        assert (np.abs(innovations - expected_innovations) <= scale).all()
        assert (stage.open, stage.openings) == (paper.open, paper.openings)
        found, counted = stage.take_consistency(), paper.take_consistency()
        assert (found.closed, found.open) == (counted.closed, counted.open)
        assert found.squares == pytest.approx(counted.squares, rel=1e-8, abs=1e-9)


def test_the_streams_of_these_tests_open_and_close_the_gate_and_settle():
    """Otherwise the tests above would say little."""
    random = np.random.default_rng(3)
    stamps = EPOCH + 333_300 * np.arange(4000)
    values = REFERENCE + WHITE / np.sqrt(333_300e-9) * random.standard_normal(4000)
    values[2500:2510] += 1e4
    stage = KalmanStage(SMOOTH, REFERENCE)
    stage.run(stamps[:2000], values[:2000])
    level, dt = stage._filter.level, 333_300e-9
    assert isinstance(course(level, Steps(dt, dt), values[:2]).variances, float)
    stage.run(stamps[2000:2600], values[2000:2600])
    assert stage.open
    stage.run(stamps[2600:], values[2600:])
    assert not stage.open
    assert stage.openings == 1


@given(
    st.floats(1e-9, 1.0, exclude_max=True),
    st.floats(-1e6, 1e6),
    st.integers(0, 2**32 - 1),
    st.floats(1e-300, 1e200),
    st.booleans(),
)
@example(0.5, -0.0, 0, 0.0, True)
def test_the_low_pass_in_bulk_is_its_step_bit_for_bit(keep, level, seed, scale, constant):
    random = np.random.default_rng(seed)
    values = scale * random.standard_normal(low_passes.FEWEST)
    keeps = np.full(len(values), keep) if constant else random.random(len(values))
    expected = [level]
    for factor, value in zip(keeps.tolist(), values.tolist(), strict=True):
        expected.append(low_pass_step(expected[-1], factor, value))
    found = low_pass(level, keep if constant else keeps, values)
    assert found.tobytes() == np.array(expected).tobytes()


@pytest.mark.parametrize("keep", [0.99, np.linspace(0.5, 0.999, 1000)], ids=["constant", "varying"])
def test_a_machine_whose_scipy_rounds_differently_goes_without_it(monkeypatch, keep):
    import scipy.linalg.lapack
    import scipy.signal

    values = np.random.default_rng(2).standard_normal(1000)
    expected = low_pass(1.0, keep, values)
    filtered, solved = scipy.signal.lfilter, scipy.linalg.lapack.dgttrs
    monkeypatch.setattr(scipy.signal, "lfilter", lambda *given, **more: [filtered(*given, **more)[0] * (1.0 + 1e-15)])
    upset = np.linspace(1.0, 1.0 + 1e-14, 201)
    monkeypatch.setattr(scipy.linalg.lapack, "dgttrs", lambda *of: (solved(*of)[0] * upset, 0))
    load_compiled.cache_clear()
    try:
        assert load_compiled() == NOTHING
        assert low_pass(1.0, keep, values).tobytes() == expected.tobytes()
    finally:
        load_compiled.cache_clear()


def test_this_machine_has_the_compiled_routines():
    """Else the tests of them would compare the loop with itself. FMA rounds otherwise: there is none on x86-64."""
    if platform.machine() == "x86_64":
        assert None not in load_compiled()


@settings(deadline=None, max_examples=25)
@given(st.integers(0, 2**32 - 1), st.integers(1, 3 * low_passes.LONGEST), st.sampled_from([0.0, 0.001, 1.0]))
@example(0, low_passes.LONGEST, 0.0)
@example(0, low_passes.LONGEST + 1, 0.0)
@example(0, low_passes.LONGEST + 2, 0.0)
def test_the_low_pass_with_a_gain_of_each_sample_is_its_step_bit_for_bit(seed, count, zeros):
    random = np.random.default_rng(seed)
    values = np.where(random.random(count) < zeros, random.choice([0.0, -0.0], count), random.standard_normal(count))
    keeps = 1.0 - 10.0 ** random.uniform(-12.0, 0.0, count)
    expected = [-0.0]
    for factor, value in zip(keeps.tolist(), values.tolist(), strict=True):
        expected.append(low_pass_step(expected[-1], factor, value))
    assert low_pass(-0.0, keeps, values).tobytes() == np.array(expected).tobytes()


def test_a_level_beyond_all_numbers_is_the_steps_too():
    values = np.full(1000, np.finfo(np.float64).max)
    values[::7] *= -1.0
    keeps = np.full(1000, 2.0)
    with np.errstate(over="ignore", invalid="ignore"):
        expected = [1.0]
        for value in values.tolist():
            expected.append(low_pass_step(expected[-1], 2.0, value))
        assert np.array_equal(low_pass(1.0, keeps, values), expected, equal_nan=True)


def test_single_samples_never_load_scipy_signal():
    code = f"""
import sys, numpy as np
from hgma_compensation.kalman.random_walk import RandomWalkNoise
from hgma_compensation.kalman.settings import FilterMode, FilterSettings
from hgma_compensation.kalman.stage import KalmanStage
stage = KalmanStage(FilterSettings(FilterMode.SMOOTH, RandomWalkNoise(1.0, 100.0)), 0.0)
stamps, values = {EPOCH} + 1_000_000 * np.arange(2000), np.zeros(2000)
for k in range(1000):
    stage.run(stamps[k : k + 1], values[k : k + 1])
print("scipy.signal" in sys.modules)
stage.run(stamps[1000:], values[1000:])
print("scipy.signal" in sys.modules)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["False", "True"]


@given(st.floats(1e-3, 1e4), st.floats(1e-6, 10.0))
def test_at_an_even_interval_the_gain_comes_to_stand_still(seconds_of_samples, interval):
    level = RandomWalkFilter(RandomWalkNoise.with_time_constant(WHITE, seconds_of_samples * interval))
    level.start(0.0, level.sample_variance(interval))
    steps = Steps(interval, interval)
    for _ in range(25):
        found = course(level, steps, np.zeros(int(seconds_of_samples) + 10))
        if isinstance(found.variances, float):
            return
        assert (np.diff(found.variances) <= 0.0).all()
        found.take(level, len(found.variances) - 1)
    pytest.fail("the variance still moves after 25 time constants")


@settings(deadline=None)
@given(
    st.sampled_from([*CLOCKS, "a few ns"]),
    st.integers(0, 2**32 - 1),
    st.lists(st.integers(0, 300), max_size=4),
)
def test_intervals_of_many_stamps_are_those_one_by_one(kind, seed, cuts):
    random = np.random.default_rng(seed)
    stamps = np.cumsum(random.integers(0, 2, 300)) if kind == "a few ns" else clock(kind, 300, random)
    many, single = Intervals(), Intervals()
    many.newest = single.newest = int(stamps[0])
    # Cut also right behind the change of the rate, where the interval is still on its way.
    for part in np.split(stamps, sorted([*cuts, 151])):
        if len(part):
            found = np.column_stack(many.steps(part).each(len(part)))
            assert found.tobytes() == np.array([single.step(stamp) for stamp in part.tolist()]).tobytes()
    assert vars(many) == vars(single)


@pytest.mark.parametrize("length", [1, 100])
def test_samples_1_ns_apart_have_an_interval(length):
    stamps, stage = EPOCH + np.arange(100), KalmanStage(SMOOTH, REFERENCE)
    outputs = [stage.run(part, REFERENCE + 1e3 * np.sin(part - EPOCH))[0] for part in np.split(stamps, 100 // length)]
    assert np.isfinite(outputs).all()
    assert stage.take_consistency().closed == 99


def test_steps_that_differ_by_rounding_are_one_interval_and_others_are_not():
    intervals = Intervals()
    intervals.newest = EPOCH
    dts, stamp = [], EPOCH
    for step in (333_334, 333_333, 333_335, 333_336, 333_335, 333_334, 333_337):
        stamp += step
        dts.append(round(intervals.step(stamp)[0] * 1e9))
    # Held to the step that set it, not to the one before: it does not creep.
    assert dts == [333_334, 333_334, 333_334, 333_336, 333_336, 333_334, 333_337]


@pytest.mark.parametrize("rate", [3e3, 3e5])
def test_holding_the_interval_over_rounded_stamps_changes_next_to_nothing(rate):
    count = 20_000
    stamps = EPOCH + np.rint(np.arange(count) * 1e9 / rate).astype(np.int64)
    assert set(np.diff(stamps).tolist()) == {int(1e9 / rate), int(1e9 / rate) + ROUNDING}
    deviation = WHITE * np.sqrt(rate)
    values = REFERENCE + deviation * np.random.default_rng(5).standard_normal(count)
    noise = RandomWalkNoise.with_time_constant(WHITE, 300.0 / rate)
    held, _ = filter_samples(noise, stamps, values)
    exact = sequential_kalman.RandomWalkFilter(noise)
    exact.start(float(values[0]))
    expected = [float(values[0])]
    for dt, value in zip((np.diff(stamps) * 1e-9).tolist(), values[1:].tolist(), strict=True):
        variance = exact.predict(dt)
        exact.correct(value - exact.estimate, variance)
        expected.append(exact.estimate)
    # R and Q are wrong by 1 ns in the interval, and the estimate by no more than as much of its own deviation, RMS.
    smoothed = deviation / np.sqrt(2.0 * 300.0)
    difference = (held - expected)[1000:]
    assert 0.0 < np.sqrt((difference**2).mean()) <= 1e-9 * rate * smoothed
    assert np.abs(difference).max() <= 5e-9 * rate * smoothed


def test_a_pause_within_many_samples_is_one():
    stamps = EPOCH + 1_000_000 * np.arange(200) + np.where(np.arange(200) >= 100, 50_000_000, 0)
    intervals = Intervals()
    intervals.newest = int(stamps[0]) - 1_000_000
    steps = intervals.steps(stamps)
    dt, averaged = steps.each(200)
    assert dt[100] == pytest.approx(0.051)
    assert averaged[100] == pytest.approx(PAUSE * 0.001)


def test_a_process_with_a_stream_to_serve_does_not_wait_for_the_loading_of_the_fast_filter():
    script = """
import sys, threading
from hgma_compensation.kalman.low_pass import LFILTER, NOTHING
LFILTER.wait = False
assert LFILTER.get() == NOTHING
assert "loading" in [thread.name for thread in threading.enumerate()]
[thread.join() for thread in threading.enumerate() if thread.name == "loading"]
assert LFILTER.get() != NOTHING
assert "scipy.signal" in sys.modules
"""
    subprocess.run([sys.executable, "-c", script], check=True)
