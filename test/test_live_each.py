"""Samples that are looked at together give what they give one after the other."""

from itertools import pairwise

import numpy as np
from builders import LINEAR, make_calibration
from effect_calibrations import calibrations, with_all_inputs
from hypothesis import given, settings
from hypothesis import strategies as st

from hgma_compensation.kalman.settings import FilterMode
from hgma_compensation.pipeline.compensated import Compensated
from hgma_compensation.pipeline.live import LiveCompensation
from hgma_compensation.pipeline.status import UNUSABLE
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


def run(stamps, values, cuts, calibration, stop, *, together):
    """Return the results of all batches as bytes, their rows and the counts; slow inputs come before each batch."""
    live = LiveCompensation()
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
            result = live.compensate(stamps[row : row + 1], values[row : row + 1])
            if result is not None:
                rows.append(row)
                outputs.append([getattr(result.compensated, name).tobytes() for name in Compensated.FIELDS])
    joined = [b"".join(parts) for parts in zip(*outputs, strict=True)]
    return joined, rows, dict(live.counts), live.received, live.compensated


@settings(max_examples=60, deadline=None)
@given(streams(), calibrations(), st.booleans())
def test_a_batch_of_messages_is_its_messages_one_after_the_other(stream, calibration, stop):
    together = run(*stream, calibration, stop, together=True)
    alone = run(*stream, calibration, stop, together=False)
    assert together[1:] == alone[1:]
    assert together[0] == alone[0]


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
