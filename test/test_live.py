import numpy as np
import pytest
from builders import LINEAR, make_calibration, make_recording
from effect_calibrations import OFFERED, applied, with_all_inputs

from hgma_compensation.effects.applied import AppliedEffect
from hgma_compensation.effects.effect import Need
from hgma_compensation.effects.registry import make
from hgma_compensation.kalman.settings import FilterMode
from hgma_compensation.pipeline.live import LiveCompensation
from hgma_compensation.pipeline.live_memory import SLOW_INPUTS
from hgma_compensation.pipeline.live_samples import single_sample
from hgma_compensation.pipeline.reasons import REMEDIES, Note, Skip, sample_name, status_name
from hgma_compensation.pipeline.remembered import REMEMBERED, Remembered
from hgma_compensation.pipeline.status import TemperatureStatus
from hgma_compensation.pipeline.stretches import Cut
from hgma_compensation.pipeline.taking_up import DROPPED
from hgma_compensation.pipeline.transport import TRANSPORT_REMEDIES
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
    live.compensate(*single_sample(1, bad[0]))
    live.install(make_calibration())
    outputs = [live.compensate(*single_sample(row + 1, bad[row])) for row in range(10)]
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
    assert live.compensate(np.array([1]), values) is not None


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
    live.add_temperature(1, 25.0)
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
    bad = [sample for sample in Sample if sample is not Sample.USED]
    names = {reason.value for reason in (*Skip, *Note, *DROPPED)} | {
        cut.value for cut in Cut if cut not in (Cut.NONE, Cut.GAP)
    }
    names |= {sample_name(need, sample) for need in SLOW_INPUTS for sample in bad}
    names |= {status_name(status) for status in TemperatureStatus if status is not TemperatureStatus.OK}
    names |= set(TRANSPORT_REMEDIES)
    assert names - {f"supply_voltage_{what}" for what in ("moved", "stuck", "jumped")} == set(REMEDIES)
    assert not any("{" in remedy for remedy in REMEDIES.values())


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


def needy_calibration(*names):
    effects = {effect.name: effect for effect in OFFERED[LINEAR[2]]}
    random = np.random.default_rng(3)
    return make_calibration(channels=LINEAR[2:], effects=[applied(LINEAR[2], effects[name], random) for name in names])


def feed_all(live, recording):
    for add, series in (
        (live.add_temperature, recording.temperature),
        (live.add_temperature_2, recording.temperature_2),
        (live.add_supply_voltage, recording.supply_voltage),
    ):
        for stamp, value in zip(series.stamps.tolist(), series.values.tolist(), strict=True):
            add(stamp, value)


def test_a_calibration_swapped_in_knows_every_input_from_before():
    recording, live = with_all_inputs(), LiveCompensation()
    live.install(make_calibration())
    feed_all(live, recording)
    live.compensate(recording.stamps[:300], recording.values[:300])
    second = needy_calibration("thermal_gradient", "supply_voltage", "thermal_lag", "warm_up")
    live.install(second)
    result = live.compensate(recording.stamps[300:], recording.values[300:])
    expected = compensate_recording(recording, second).values[300:]
    np.testing.assert_array_equal(result.compensated.values, expected)
    assert not live.missing_inputs


def test_a_calibration_swapped_in_after_hours_has_the_memory_of_one_that_was_there():
    effects = [
        AppliedEffect(LINEAR[2], make("warm_up", {"time_constant": 900.0, "spread": 1.0}), np.array([2.0])),
        AppliedEffect(LINEAR[2], make("stress_relaxation", {"time_constant": 5000.0, "spread": 1.0}), np.ones(1)),
    ]
    calibration = make_calibration(channels=LINEAR[2:], effects=effects)
    there, later = LiveCompensation(), LiveCompensation()
    there.install(calibration)
    later.install(make_calibration(channels=LINEAR[2:]))
    seconds = np.concatenate([np.arange(0, 4000), np.arange(5000, 5000 + 2 * REMEMBERED)])
    for second in seconds.tolist():
        for live in (there, later):
            live.add_temperature(second * NANOSECONDS, 25.0 + 20.0 * np.sin(second / 2000.0))
    later.install(calibration)
    sample = single_sample((5000 + 2 * REMEMBERED) * NANOSECONDS, np.zeros(6))
    one, other = (live.compensate(*sample).compensated.drift[0, 0] for live in (there, later))
    assert other == pytest.approx(one, abs=0.05)
    later.install(make_calibration(channels=LINEAR[2:]))
    plain = later.compensate(*sample).compensated.drift[0, 0]
    assert abs(plain - one) > 1.0


def test_what_is_remembered_is_recent_or_thinned_and_bounded():
    remembered = Remembered()
    for second in range(0, 40 * REMEMBERED):
        remembered.add(second * NANOSECONDS, float(second))
    stamps = np.array([stamp for stamp, _ in remembered])
    steps = np.diff(stamps) // NANOSECONDS
    assert len(stamps) <= 2 * REMEMBERED
    assert steps[-REMEMBERED + 1 :].tolist() == [1] * (REMEMBERED - 1)
    assert set(steps[: -REMEMBERED - 1]) == {30}
    assert remembered.power_on == 0
    begin = 41 * REMEMBERED
    for second in range(begin, begin + 40 * REMEMBERED):
        remembered.add(second * NANOSECONDS, float(second))
    assert remembered.power_on in (0, begin * NANOSECONDS)
    assert (next(iter(remembered))[0] >= begin * NANOSECONDS) == (remembered.power_on > 0)
    remembered.clear()
    assert list(remembered) == []
    assert remembered.power_on is None


def without_statuses(live):
    return {name: count for name, count in live.counts.items() if not name.startswith("temperature_status")}


def test_inputs_that_effects_need_and_that_never_came_are_counted_with_each_sample():
    recording, live = with_all_inputs(), LiveCompensation()
    live.install(needy_calibration("thermal_gradient", "supply_voltage"))
    feed_temperature(live)
    live.compensate(recording.stamps[:7], recording.values[:7])
    live.add_temperature_2(int(recording.stamps[7]), 20.0)
    live.compensate(recording.stamps[7:10], recording.values[7:10])
    assert without_statuses(live) == {Note.TEMPERATURE_2_MISSING.value: 7, Note.SUPPLY_VOLTAGE_MISSING.value: 10}
    assert live.missing_inputs == (Need.SUPPLY_VOLTAGE,)
    live.reset()
    assert live.missing_inputs == (Need.TEMPERATURE_2, Need.SUPPLY_VOLTAGE)


def test_bad_samples_of_the_other_inputs_are_counted_by_name_where_they_matter():
    live = LiveCompensation()
    live.install(make_calibration())
    live.add_temperature_2(10, np.nan)
    assert not live.counts
    live.install(needy_calibration("thermal_gradient", "supply_voltage"))
    live.counts.clear()
    for stamp, value in ((20, 25.0), (20, 25.0), (19, 25.0), (21, np.nan), (22, 1e6)):
        live.add_temperature_2(stamp, value)
        live.add_supply_voltage(stamp, value)
    live.compensate(*single_sample(2 * NANOSECONDS, np.zeros(6)))
    live.add_supply_voltage(NANOSECONDS, 5.0)
    names = {"stamp_repeated", "out_of_order", "not_finite", "implausible"}
    expected = {f"{need}_{name}": 1 for need in ("temperature_2", "supply_voltage") for name in names}
    assert without_statuses(live) == {**expected, Note.SUPPLY_VOLTAGE_LATE.value: 1}
    assert set(live.counts) <= set(REMEDIES)


def test_a_channel_that_an_effect_reads_must_be_finite():
    live = LiveCompensation()
    effect = AppliedEffect(LINEAR[2], make("cross_axis", {"source": LINEAR[0]}), np.ones(1))
    live.install(make_calibration(channels=LINEAR[2:], effects=[effect]))
    assert live.compensate(*single_sample(1, [np.nan, 0.0, 0.0, 0.0, 0.0, 0.0])) is None
    assert live.compensate(*single_sample(2, [0.0, np.nan, 0.0, 0.0, 0.0, 0.0])) is not None
    assert without_statuses(live) == {Skip.NOT_FINITE.value: 1}
