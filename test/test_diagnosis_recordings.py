from dataclasses import replace

import numpy as np
import pytest
from builders import EPOCH, make_recording
from diagnosis_blocks import make_blocks_of

from hgma_compensation.diagnosis.recordings import HELD_OUT, arrange
from hgma_compensation.recording.recording import Series
from hgma_compensation.stamps import NANOSECONDS

LASTS = 100.0


def recording(name, start):
    made = make_recording(duration_s=LASTS, accel_rate=5.0, thermistor_rate=1.0, name=name)
    shift = int(start * NANOSECONDS)
    series = Series(made.temperature.stamps + shift, made.temperature.values)
    return replace(made, stamps=made.stamps + shift, temperature=series, temperature_2=series)


FIRST, SECOND, THIRD = recording("first", 0.0), recording("second", 5000.0), recording("third", 9000.0)


def names(material):
    return [one.name for one in material.recordings]


def held(material):
    """Return the share of each recording's samples that are held out."""
    return [float(material.held_out(one.stamps, one).mean()) for one in material.recordings]


def test_the_recording_given_is_held_out_wherever_it_stands_in_time():
    for holdout, others in ((FIRST, [SECOND, THIRD]), (SECOND, [THIRD, FIRST]), (THIRD, [FIRST, SECOND])):
        material = arrange(others, holdout)
        assert names(material) == ["first", "second", "third"]
        assert material.holdout == holdout.name
        assert held(material) == [float(one == holdout.name) for one in names(material)]
        assert material.held == (int(holdout.stamps.min()), int(holdout.stamps.max()))


def test_without_one_the_last_of_several_is_held_out():
    material = arrange([THIRD, FIRST, SECOND], None)
    assert material.holdout == "third"
    assert held(material) == [0.0, 0.0, 1.0]


def test_of_a_single_recording_its_end_is_held_out():
    material = arrange([FIRST], None)
    assert (names(material), material.holdout) == (["first"], "first")
    out = material.held_out(FIRST.stamps, FIRST)
    assert out.mean() == pytest.approx(HELD_OUT, abs=0.01)
    assert not out[: int(0.74 * len(out))].any()
    assert out[int(0.76 * len(out)) :].all()


@pytest.mark.parametrize(("pause", "joined"), [(30.0, True), (90.0, False)])
def test_a_recording_that_goes_on_soon_after_another_is_joined_to_it(pause, joined):
    after = recording("after", LASTS + pause)
    material = arrange([FIRST], after)
    assert names(material) == (["first+after"] if joined else ["first", "after"])
    assert material.holdout == "after"
    if joined:
        whole = material.recordings[0]
        np.testing.assert_array_equal(whole.stamps, np.concatenate([FIRST.stamps, after.stamps]))
        np.testing.assert_array_equal(whole.values, np.concatenate([FIRST.values, after.values]))
        for name in ("temperature", "temperature_2"):
            parts = [getattr(FIRST, name).values, getattr(after, name).values]
            np.testing.assert_array_equal(getattr(whole, name).values, np.concatenate(parts))
        np.testing.assert_array_equal(material.held_out(whole.stamps, whole), whole.stamps >= after.stamps[0])


@pytest.mark.parametrize("change", [{"frame": "other"}, {"present": ("linear_acceleration.x",)}])
def test_another_sensor_is_no_continuation(change):
    after = replace(recording("after", LASTS + 10.0), **change)
    assert names(arrange([FIRST], after)) == ["first", "after"]


def test_a_hold_out_of_the_same_name_and_time_is_told_apart():
    material = arrange([FIRST], replace(recording("first", 0.0), values=FIRST.values + 1.0))
    assert names(material) == ["first", "first (hold-out)"]
    assert held(material) == [0.0, 1.0]


@pytest.mark.parametrize("start", [5000.0, LASTS + 10.0])
def test_a_plus_in_a_name_is_part_of_it(start):
    material = arrange([FIRST], recording("hot+cold", start))
    out = [material.held_out(one.stamps, one) for one in material.recordings]
    assert np.concatenate(out).mean() == 0.5


def test_blocks_of_the_hold_out_are_marked():
    material = arrange([FIRST], SECOND)
    blocks = make_blocks_of(np.zeros(20), seconds=5.0, runs=2)
    stamps = np.where(blocks.run == 0, EPOCH, SECOND.start) + 5 * NANOSECONDS
    rows = material.held_rows(replace(blocks, stamps=stamps))
    np.testing.assert_array_equal(rows, blocks.run == 1)
