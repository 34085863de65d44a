import json

import numpy as np
import pytest
from builders import EPOCH

from hgma_compensation.pipeline.held_series import HeldSeries
from hgma_compensation.stamps import NANOSECONDS
from hgma_compensation.temperature.track import Sample
from hgma_compensation.time_jumps import TIME_JUMP

SECOND, LATENCY = NANOSECONDS, NANOSECONDS // 4


def filled(count=3):
    series = HeldSeries(0.25, (0.0, 100.0))
    for number in range(count):
        assert series.add(EPOCH + number * SECOND, 5.0 + number) is Sample.USED
    return series


def test_a_sample_counts_from_exactly_the_latency_on_and_is_held():
    edges = EPOCH + np.arange(3) * SECOND + LATENCY
    at = np.sort(np.concatenate([edges - 1, edges, edges[-1:] + 3600 * SECOND]))
    np.testing.assert_array_equal(filled().read(at), [np.nan, 5.0, 5.0, 6.0, 6.0, 7.0, 7.0])


def test_after_a_pause_too_a_sample_counts_from_the_latency_on():
    series, stamp = filled(), EPOCH + 500 * SECOND
    series.add(stamp, 9.0)
    np.testing.assert_array_equal(series.read(stamp + np.array([0, LATENCY - 1, LATENCY])), [7.0, 7.0, 9.0])


def test_nothing_is_known_before_the_first_sample():
    series = HeldSeries(0.25, (0.0, 100.0))
    assert len(series) == 0
    assert np.isnan(series.read(np.array([EPOCH]))).all()


@pytest.mark.parametrize(
    ("stamp", "value", "outcome"),
    [
        (EPOCH + 9 * SECOND, np.nan, Sample.NOT_FINITE),
        (EPOCH + 9 * SECOND, -np.inf, Sample.NOT_FINITE),
        (EPOCH + 9 * SECOND, 100.1, Sample.IMPLAUSIBLE),
        (0, 4.0, Sample.NOT_STAMPED),
        (EPOCH + 2 * SECOND, 4.0, Sample.REPEATED),
        (EPOCH + 2 * SECOND - 1, 4.0, Sample.OUT_OF_ORDER),
        (EPOCH + 2 * SECOND - TIME_JUMP, 4.0, Sample.OUT_OF_ORDER),
    ],
)
def test_a_sample_that_cannot_be_used_is_named_and_changes_nothing(stamp, value, outcome):
    series = filled()
    assert series.add(stamp, value) is outcome
    at = EPOCH + np.arange(0, 20) * SECOND
    np.testing.assert_array_equal(series.read(at), filled().read(at))


def test_a_jump_back_begins_anew():
    series = filled()
    assert series.add(EPOCH - TIME_JUMP, 3.3) is Sample.RESTARTED
    at = np.array([EPOCH - TIME_JUMP, EPOCH + 10 * SECOND])
    np.testing.assert_array_equal(series.read(at), [np.nan, 3.3])


def test_a_snapshot_goes_on():
    series, restored = filled(), HeldSeries(0.25, (0.0, 100.0))
    restored.restore(json.loads(json.dumps(series.snapshot(1.0), allow_nan=False)))
    at = EPOCH + np.arange(1, 9) * SECOND + LATENCY
    for one in (series, restored):
        one.add(EPOCH + 5 * SECOND, 9.0)
    np.testing.assert_array_equal(restored.read(at), series.read(at))
