"""Samples that are looked at together give what they give one after the other."""

from itertools import pairwise

import numpy as np
from builders import LINEAR, make_calibration
from effect_calibrations import OFFERED, applied, calibrations, with_all_inputs
from hypothesis import given, settings
from hypothesis import strategies as st

from hgma_compensation.kalman.settings import FilterMode
from hgma_compensation.pipeline.compensated import Compensated
from hgma_compensation.pipeline.live import LiveCompensation
from hgma_compensation.pipeline.pipeline import Pipeline
from hgma_compensation.pipeline.screening import usable_samples
from hgma_compensation.pipeline.status import UNUSABLE
from hgma_compensation.recording.compensated_bag import feed
from hgma_compensation.stamps import NANOSECONDS

RECORDING = with_all_inputs()
COUNT = 300
SLOW = ("temperature", "temperature_2", "supply_voltage")


@st.composite
def streams(draw):
    """Rows of the recording with what a stream may do to them, cut into the batches in which they arrive."""
    stamps, values = RECORDING.stamps[:COUNT].copy(), RECORDING.values[:COUNT].copy()
    for _ in range(draw(st.integers(0, 4))):
        row = draw(st.integers(0, COUNT - 1))
        match draw(st.sampled_from(["nan", "huge", "repeat", "late", "back", "ahead", "zero"])):
            case "nan":
                values[row, draw(st.integers(0, 5))] = np.nan
            case "huge":
                values[row, draw(st.integers(0, 5))] = 1e7
            case "repeat":
                stamps[row] = stamps[max(row - 1, 0)]
            case "late":
                stamps[row] -= 300_000_000
            case "back":
                stamps[row:] -= 20 * NANOSECONDS
            case "ahead":
                stamps[row:] += draw(st.sampled_from([6, 100])) * NANOSECONDS
            case "zero":
                stamps[row] = 0
    cuts = sorted(draw(st.lists(st.integers(1, COUNT - 1), max_size=12, unique=True)))
    return stamps, values, [0, *cuts, COUNT]


def run(stamps, values, cuts, calibration, stop, *, together=False, ordinary=False):
    """Return the results of all batches as bytes, their rows and the counts; slow inputs come before each batch.

    ordinary: whether samples of which nothing is to be said are taken in plain numbers, whose values are all there is.
    """
    live = LiveCompensation()
    live.ordinary = 0
    live.stop_on = UNUSABLE if stop else frozenset()
    live.install(calibration)
    given_until = dict.fromkeys(SLOW, 0)
    outputs, rows = [], []
    for begin, end in pairwise(cuts):
        for name in SLOW:
            series = getattr(RECORDING, name)
            while (
                given_until[name] < len(series.stamps) and series.stamps[given_until[name]] <= RECORDING.stamps[end - 1]
            ):
                at = given_until[name]
                getattr(live, f"add_{name}")(int(series.stamps[at]), float(series.values[at]))
                given_until[name] += 1
        if together:
            found = live.compensate_each(stamps[begin:end], values[begin:end])
            if found is not None:
                rows += (found[1] + begin).tolist()
                outputs.append([getattr(found[0].compensated, name).tobytes() for name in Compensated.FIELDS])
            continue
        for row in range(begin, end):
            if (
                ordinary
                and (found := live.compensate_ordinary(int(stamps[row]), tuple(values[row].tolist()))) is not None
            ):
                rows.append(row)
                outputs.append([np.array(found).tobytes()])
                live.ordinary += 1
                continue
            result = live.compensate(stamps[row : row + 1], values[row : row + 1])
            if result is not None:
                rows.append(row)
                names = Compensated.FIELDS[:1] if ordinary else Compensated.FIELDS
                outputs.append([getattr(result.compensated, name).tobytes() for name in names])
    joined = [b"".join(parts) for parts in zip(*outputs, strict=True)]
    rest = [live.observer.problems(), live.observer.values(), live.position, live.ordinary > 0]
    return joined, rows, dict(live.counts), live.received, live.compensated, rest


@settings(max_examples=60, deadline=None)
@given(streams(), calibrations(), st.booleans())
def test_a_batch_of_messages_is_its_messages_one_after_the_other(stream, calibration, stop):
    together = run(*stream, calibration, stop, together=True)
    alone = run(*stream, calibration, stop, together=False)
    assert together[1:5] == alone[1:5]
    assert together[0] == alone[0]


@settings(max_examples=40, deadline=None)
@given(streams(), st.integers(1, 5), st.booleans())
def test_samples_of_which_nothing_is_to_be_said_are_those_that_are_looked_at(stream, seed, stop):
    slow = [effect for effect in OFFERED[LINEAR[1]] if effect.slow]
    effects = [applied(LINEAR[1], effect, np.random.default_rng(seed)) for effect in slow[seed :: len(slow) // 2]]
    calibration = make_calibration(seed, channels=LINEAR[1:], effects=effects)
    plain, looked_at = (run(*stream, calibration, stop, ordinary=ordinary) for ordinary in (True, False))
    assert plain[0] == looked_at[0][:1]
    assert plain[1:5] == looked_at[1:5]
    assert plain[5][:3] == looked_at[5][:3]


def test_most_samples_of_a_still_stream_have_nothing_to_be_said_of_them():
    live = LiveCompensation()
    live.install(make_calibration(channels=LINEAR))
    ordinary = 0
    for row in range(COUNT):
        stamp = int(RECORDING.stamps[row]) + 20 * NANOSECONDS
        live.add_temperature(stamp, 25.0 + 0.001 * (row % 3))
        for part in range(1, 11):
            at = stamp + part * 9_000_000
            if live.compensate_ordinary(at, tuple(RECORDING.values[row].tolist())) is not None:
                ordinary += 1
            else:
                live.compensate(np.array([at]), RECORDING.values[row : row + 1])
    # The delay of ΔT is 20 s of the 30 s.
    assert ordinary > 0.7 * 10 * COUNT / 3
    assert live.received == live.compensated == 10 * COUNT


def test_without_a_calibration_all_are_counted():
    live = LiveCompensation()
    assert live.compensate_each(RECORDING.stamps[:5], RECORDING.values[:5]) is None
    assert live.counts == {"no_calibration": 5}
    assert live.received == 5


def test_a_batch_of_which_nothing_is_usable_gives_nothing():
    live = LiveCompensation()
    live.install(make_calibration(channels=LINEAR, mode=FilterMode.SMOOTH))
    assert live.compensate_each(RECORDING.stamps[:3], np.full((3, 6), np.nan)) is None
    assert live.counts == {"acceleration_not_finite": 3}


@settings(max_examples=30, deadline=None)
@given(streams(), calibrations(), st.lists(st.integers(0, COUNT - 1), max_size=5))
def test_what_is_said_of_some_samples_is_what_is_said_of_all(stream, calibration, rows):
    stamps, values, _ = stream
    pipeline = Pipeline(calibration)
    feed(pipeline, RECORDING)
    good = usable_samples(stamps, values)
    whole = pipeline.compensate(stamps[good], pipeline.columns.of(values[good]), values[good])
    chosen = np.array(rows, dtype=np.int64) % good.sum()
    some = whole.take(chosen)
    for name in Compensated.FIELDS:
        assert getattr(some, name).tobytes() == getattr(whole, name)[chosen].tobytes(), name
