import numpy as np
from builders import make_calibration, make_recording

from hgma_compensation.kalman.settings import FilterMode
from hgma_compensation.pipeline.live import LiveCompensation, single_sample
from hgma_compensation.pipeline.reasons import REMEDIES, Note, Skip
from hgma_compensation.recording.compensated_bag import compensate_recording
from hgma_compensation.stamps import NANOSECONDS
from hgma_compensation.temperature.track import Sample

RECORDING = make_recording(duration_s=60.0, accel_rate=10.0, thermistor_rate=2.0, cycles=1.0)


def feed_temperature(live, until=None):
    for stamp, celsius in zip(RECORDING.temperature.stamps.tolist(), RECORDING.temperature.values, strict=True):
        if until is None or stamp <= until:
            live.add_temperature(stamp, float(celsius))


def test_in_equals_out_plus_counted_skips():
    live = LiveCompensation()
    bad = RECORDING.values.copy()
    bad[3, 0] = np.nan
    bad[5, 2] = np.inf
    live.compensate(*single_sample(0, bad[0]))
    live.install(make_calibration())
    outputs = [live.compensate(*single_sample(row, bad[row])) for row in range(10)]
    live.skip_unseen(Skip.NOT_ACTIVE, 4)
    assert [row for row, result in enumerate(outputs) if result is None] == [3, 5]
    assert live.counts[Skip.NO_CALIBRATION.value] == 1
    assert live.counts[Skip.NOT_FINITE.value] == 2
    assert live.received == live.compensated + live.skipped() == 15


def test_a_number_that_is_not_finite_leaves_no_trace_in_the_filter():
    with_nan, without = LiveCompensation(), LiveCompensation()
    for live in (with_nan, without):
        live.install(make_calibration(mode=FilterMode.SMOOTH))
        feed_temperature(live)
        live.compensate(RECORDING.stamps[:50], RECORDING.values[:50])
    broken = np.full((1, 6), np.nan)
    assert with_nan.compensate(RECORDING.stamps[50:51], broken) is None
    one = with_nan.compensate(RECORDING.stamps[51:], RECORDING.values[51:])
    other = without.compensate(RECORDING.stamps[51:], RECORDING.values[51:])
    assert one.compensated.values.tobytes() == other.compensated.values.tobytes()


def test_a_channel_without_calibration_may_hold_anything():
    live = LiveCompensation()
    live.install(make_calibration(channels=("linear_acceleration.z",)))
    values = np.array([[np.nan, 0.0, 1.0, np.inf, 0.0, 0.0]])
    assert live.compensate(np.array([0]), values) is not None


def test_a_calibration_swapped_in_knows_the_thermistor_from_before():
    first, second = make_calibration(seed=1), make_calibration(seed=9)
    live = LiveCompensation()
    live.install(first)
    feed_temperature(live)
    live.compensate(RECORDING.stamps[:300], RECORDING.values[:300])
    live.install(second)
    result = live.compensate(RECORDING.stamps[300:], RECORDING.values[300:])
    expected = compensate_recording(RECORDING, second).values[300:]
    assert result.calibration is second
    np.testing.assert_array_equal(result.compensated.values, expected)


def test_a_thermistor_sample_that_should_have_been_used_before_is_counted():
    live = LiveCompensation()
    live.install(make_calibration(latency=0.1))
    live.add_temperature(0, 25.0)
    live.compensate(*single_sample(2 * NANOSECONDS, np.zeros(6)))
    live.add_temperature(NANOSECONDS, 25.0)
    live.add_temperature(2 * NANOSECONDS, 25.0)
    assert live.counts[Note.TEMPERATURE_LATE.value] == 1


def test_bad_thermistor_samples_are_counted_by_name():
    live = LiveCompensation()
    live.install(make_calibration())
    for stamp, celsius in ((10, 25.0), (10, 25.0), (9, 25.0), (11, np.nan), (12, 1e6)):
        live.add_temperature(stamp, celsius)
    reasons = (Sample.REPEATED, Sample.OUT_OF_ORDER, Sample.NOT_FINITE, Sample.IMPLAUSIBLE)
    assert {name: count for name, count in live.counts.items()} == {reason.value: 1 for reason in reasons}


def test_every_reason_tells_the_operator_what_to_do():
    reasons = [*Skip, *Note, *(sample for sample in Sample if sample is not Sample.USED)]
    assert {reason.value for reason in reasons} == set(REMEDIES)


def test_reset_keeps_calibration_and_counts():
    live = LiveCompensation()
    calibration = make_calibration()
    live.install(calibration)
    feed_temperature(live)
    live.compensate(RECORDING.stamps[:10], RECORDING.values[:10])
    live.reset()
    result = live.compensate(RECORDING.stamps[10:11], RECORDING.values[10:11])
    assert live.calibration is calibration
    assert live.received == live.compensated == 11
    assert result.compensated.status.tolist() == [3]
