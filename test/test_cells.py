"""Between changes of its inputs the slow drift is a line: the cells, and how far the line is off."""

from itertools import chain

import numpy as np
import pytest
from builders import EPOCH, make_calibration, make_recording, make_stamps
from effect_calibrations import OFFERED, applied, with_all_inputs
from hypothesis import given, settings
from hypothesis import strategies as st

from hgma_compensation.pipeline.cell_values import Line
from hgma_compensation.pipeline.cells import STEP, Cells, cells_of
from hgma_compensation.pipeline.pipeline import Pipeline
from hgma_compensation.pipeline.slow_drift import SlowDrift
from hgma_compensation.recording.compensated_bag import feed
from hgma_compensation.stamps import NANOSECONDS

RECORDING = with_all_inputs()
SLOW = [(channel, effect) for channel, effects in OFFERED.items() for effect in effects if effect.slow]
FINE = 65
"""Points of a cell at which the drift is evaluated exactly."""


def pipeline_on(recording, calibration):
    pipeline = Pipeline(calibration)
    feed(pipeline, recording)
    return pipeline


def exact(slow, inputs, begin, stamps):
    """Return the drift (n, c) at stamps, evaluated there, from what was known at ``begin``."""
    cells = Cells(begin, stamps, stamps)
    with np.errstate(divide="ignore"):
        values = slow.evaluate(inputs, cells)
    return values.drift.first + values.drift.change


@st.composite
def slow_calibrations(draw):
    random = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    chosen = draw(st.lists(st.sampled_from(SLOW), max_size=3))
    return make_calibration(draw(st.integers(1, 5)), effects=[applied(c, e, random) for c, e in chosen])


def bits(values):
    """Return all that holds in cells."""
    parts = [(line.first, line.change) for line in vars(values).values() if isinstance(line, Line)]
    return [array.tobytes() for array in (*chain(*parts), *(v for v in vars(values).values() if hasattr(v, "tobytes")))]


HAPPENINGS = st.lists(
    st.one_of(
        st.tuples(st.just("sample"), st.sampled_from([0.1, 0.1, 0.1, 1.0, 0.0, -0.05, 7.0, 699.75, 699.75, -300.0])),
        st.tuples(st.just("bad"), st.sampled_from([0.1, 0.0])),
        st.tuples(st.just("read"), st.one_of(st.floats(-0.3, 0.6), st.sampled_from([6.9, 7.1, 699.7, 699.7, 0.01]))),
    ),
    min_size=5,
    max_size=40,
)


@settings(max_examples=100, deadline=None)
@given(slow_calibrations(), HAPPENINGS)
def test_cells_that_are_kept_are_those_that_would_be_evaluated(calibration, happenings):
    """Whatever comes from the thermistor between two readings, at its pace, late, after a pause, or broken."""
    pipeline = Pipeline(calibration, live=True)
    kept, at = SlowDrift(calibration, pipeline.stage), EPOCH
    pipeline.add_temperature(at, 20.0)
    with np.errstate(divide="ignore"):
        for number, (what, step) in enumerate(happenings):
            if what == "read":
                stamps = np.array([at + round(step * NANOSECONDS)], dtype=np.int64)
                found, _ = kept.at(pipeline.inputs, stamps)
                anew = kept.evaluate(pipeline.inputs, cells_of(pipeline.inputs, stamps)[0])
                assert bits(found) == bits(anew)
            else:
                at += round(step * NANOSECONDS)
                value = 20.0 + 0.01 * (number % 7) if what == "sample" else float("nan")
                pipeline.add_temperature(at, value)


SECONDS = st.lists(st.floats(-5.0, 130.0), min_size=1, max_size=30)


@settings(max_examples=60)
@given(SECONDS)
def test_each_sample_lies_in_its_cell_and_has_the_same_one_alone(seconds):
    inputs = pipeline_on(RECORDING, make_calibration()).inputs
    stamps = make_stamps(np.array(seconds))
    cells, places = cells_of(inputs, stamps)
    index = np.zeros(len(stamps), dtype=np.int64) if places.index is None else places.index
    if places.counts is not None:
        index = np.repeat(np.arange(len(cells.begin)), places.counts)
    for row, cell in enumerate(index.tolist()):
        begin, end, until = (int(column[cell]) for column in (cells.begin, cells.end, cells.until))
        assert begin <= stamps[row] < until <= end <= begin + STEP
        alone, _ = cells_of(inputs, stamps[row : row + 1])
        assert [int(column[0]) for column in (alone.begin, alone.end, alone.until)] == [begin, end, until]
        assert not len(inputs.changes(begin, until))


@settings(max_examples=40, deadline=None)
@given(slow_calibrations(), st.floats(1.0, 58.0))
def test_the_line_is_off_by_no_more_than_its_bound(calibration, second):
    """The chord's bound, h²/8 · max |d²D/dt²|; for plays, whose drift has kinks, the change of the slope times h/4."""
    pipeline = pipeline_on(RECORDING, calibration)
    slow = SlowDrift(calibration, pipeline.stage)
    cells, _ = cells_of(pipeline.inputs, make_stamps(np.array([second])))
    stamps = np.linspace(int(cells.begin[0]), int(cells.end[0]), FINE).astype(np.int64)
    drift = exact(slow, pipeline.inputs, np.repeat(cells.begin, FINE), stamps)
    values = slow.evaluate(pipeline.inputs, cells)
    way = ((stamps - cells.begin[0]) * values.inverse[0])[:, None]
    off = np.abs(values.drift.first + way * values.drift.change - drift).max(axis=0)
    slopes = np.diff(drift, axis=0) * (FINE - 1)
    curvature = np.abs(np.diff(slopes, axis=0)).max(axis=0) * (FINE - 1)
    kinks = np.ptp(slopes, axis=0)
    # The rounding of stamps to nanoseconds, and that of the drift itself.
    tiny = 1e-9 * np.abs(drift).max(axis=0) + 1e-9
    assert (off <= np.minimum(1.05 * curvature / 8.0, kinks / 4.0) + tiny).all()


@pytest.mark.parametrize("duration", [600.0, 6000.0])
def test_the_line_costs_less_than_a_ten_thousandth_of_the_span_of_the_drift(duration):
    """At 14 and at 1.4 °C/min, as docs/METHOD.md states; the noise of the trend's rate bends the line too."""
    recording = make_recording(duration_s=duration, cycles=1.0, thermistor_rate=10.0)
    for seed in range(5):
        calibration = make_calibration(seed)
        pipeline = pipeline_on(recording, calibration)
        slow = SlowDrift(calibration, pipeline.stage)
        stamps = np.sort(np.random.default_rng(seed).integers(EPOCH + NANOSECONDS, int(recording.stamps[-1]), 5000))
        result = pipeline.compensate(stamps, np.zeros((len(stamps), len(calibration.names))))
        off = np.abs(result.drift - exact(slow, pipeline.inputs, stamps, stamps + 1)).max(axis=0)
        assert (off < 1e-4 * np.ptp(result.drift, axis=0)).all()


@pytest.mark.parametrize(("channel", "effect"), SLOW, ids=str)
def test_a_slow_effect_does_not_answer_to_the_acceleration(channel, effect):
    calibration = make_calibration(effects=[applied(channel, effect, np.random.default_rng(1))])
    pipeline = pipeline_on(RECORDING, calibration)
    assert not pipeline.stage.has_fast
    assert effect.acceleration_memory() is None
    drift = pipeline.compensate(RECORDING.stamps, pipeline.columns.of(RECORDING.values), RECORDING.values).drift
    assert np.isfinite(drift).all()
