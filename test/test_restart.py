import json

import numpy as np
import pytest
from builders import LINEAR, make_calibration, make_stamps
from effect_calibrations import OFFERED, applied, calibrations, switched_off, with_all_inputs
from hypothesis import given, settings
from hypothesis import strategies as st
from restarts import Stream, file_of, started

from hgma_compensation.effects.applied import AppliedEffect
from hgma_compensation.effects.registry import make
from hgma_compensation.kalman.settings import FilterMode
from hgma_compensation.pipeline.live import LiveCompensation
from hgma_compensation.pipeline.live_samples import single_sample
from hgma_compensation.pipeline.reasons import REMEDIES
from hgma_compensation.pipeline.remembered import REMEMBERED
from hgma_compensation.pipeline.taking_up import Past
from hgma_compensation.recording.compensated_bag import compensate_recording
from hgma_compensation.stamps import NANOSECONDS, to_nanoseconds

RECORDING = with_all_inputs()
SWITCHED_OFF = switched_off(RECORDING)
ROWS = len(RECORDING.stamps)
UNFILTERED = calibrations(modes=(FilterMode.OFF,))
START = int(make_stamps(np.zeros(1))[0])


@pytest.mark.parametrize("recording", [RECORDING, SWITCHED_OFF], ids=["on", "switched off"])
@settings(max_examples=12)
@given(calibration=UNFILTERED, cuts=st.sets(st.integers(1, ROWS - 1), max_size=4))
def test_any_restarts_without_a_lost_sample_change_no_bit(recording, calibration, cuts):
    stream, live, parts = Stream(recording), started(calibration), []
    for cut in [*sorted(cuts), ROWS]:
        parts.append(stream.send(live, cut))
        live = started(calibration, file_of(live))
    expected = compensate_recording(recording, calibration).drift
    assert np.concatenate(parts).tobytes() == expected.tobytes()


@pytest.mark.parametrize("number", range(len(OFFERED[LINEAR[2]])), ids=lambda n: OFFERED[LINEAR[2]][n].name)
def test_every_effect_goes_on_with_its_memory(number):
    effect = applied(LINEAR[2], OFFERED[LINEAR[2]][number], np.random.default_rng(number))
    calibration = make_calibration(channels=LINEAR[2:], effects=[effect])
    stream, live = Stream(RECORDING), started(calibration)
    stream.send(live, ROWS // 2)
    again = started(calibration, file_of(live))
    after = stream.send(again, ROWS)
    assert again.past is Past.TAKEN_UP
    assert after.tobytes() == compensate_recording(RECORDING, calibration).drift[ROWS // 2 :].tobytes()


@pytest.mark.parametrize("seconds", [20.0, 200.0])
@settings(max_examples=8)
@given(calibration=UNFILTERED)
def test_after_lost_samples_it_is_as_if_the_sensor_had_been_silent(seconds, calibration):
    half = ROWS // 2
    silent = switched_off(RECORDING, seconds)
    stream, live = Stream(silent), started(calibration)
    stream.send(live, half)
    after = stream.send(started(calibration, file_of(live)), ROWS)
    assert after.tobytes() == compensate_recording(silent, calibration).drift[half:].tobytes()


def hour_long(second_calibration):
    """Return a LiveCompensation after three hours of a slow temperature."""
    live = started(second_calibration)
    for second in range(0, 3 * 3600):
        live.add_temperature(START + second * NANOSECONDS, 25.0 + 20.0 * np.sin(second / 2000.0))
    return live


def test_a_calibration_swapped_in_after_a_restart_knows_hours_of_the_past():
    creep = AppliedEffect(LINEAR[2], make("stress_relaxation", {"time_constant": 5000.0, "spread": 1.0}), np.ones(1))
    warm = AppliedEffect(LINEAR[2], make("warm_up", {"time_constant": 3000.0, "spread": 1.0}), np.array([5.0]))
    calibration = make_calibration(channels=LINEAR[2:], effects=[creep, warm])
    plain = make_calibration(channels=LINEAR[2:])
    sample = single_sample(START + 3 * 3600 * NANOSECONDS, np.zeros(6))
    expected = hour_long(calibration).compensate(*sample).compensated.drift
    other = started(calibration, content := file_of(hour_long(plain)))
    drift = other.compensate(*sample).compensated.drift
    assert other.past is Past.REPLAYED
    assert drift == pytest.approx(expected, abs=0.05)
    same = started(plain, content)
    without = same.compensate(*sample).compensated.drift
    assert same.past is Past.TAKEN_UP
    same.install(calibration)
    assert same.compensate(*sample).compensated.drift == pytest.approx(expected, abs=0.05)
    assert abs(without - expected) > 1.0


def test_the_file_stays_small_over_days():
    live = started(make_calibration())
    for minute in range(0, 3 * REMEMBERED):
        for second in (0, 20, 40):
            live.add_temperature(START + (60 * minute + second) * NANOSECONDS, 25.0 + np.sin(minute / 100.0))
    assert len(file_of(live)) < 120_000


@pytest.mark.parametrize(
    ("seconds", "past"),
    [
        (0.1, Past.TAKEN_UP),
        (-4.0, Past.TAKEN_UP),
        (99.0, Past.TAKEN_UP),
        (101.0, Past.TOO_OLD),
        (-6.0, Past.FROM_LATER),
    ],
)
@pytest.mark.parametrize("source", ["temperature", "acceleration"])
def test_age_is_judged_by_the_stamp_of_the_first_sample(seconds, past, source):
    calibration = make_calibration()
    live = started(calibration)
    live.add_temperature(START, 40.0)
    live.compensate(*single_sample(START, np.zeros(6)))
    again = started(calibration, file_of(live), max_age=100.0)
    assert again.past is Past.WAITING
    stamp = START + to_nanoseconds(seconds)
    if source == "temperature":
        again.add_temperature(stamp, 10.0)
    else:
        again.compensate(*single_sample(stamp, np.zeros(6)))
    assert again.past is past
    dropped = past in (Past.TOO_OLD, Past.FROM_LATER)
    assert {name: count for name, count in again.counts.items() if name in (p.value for p in Past)} == (
        {past.value: 1} if dropped else {}
    )
    assert set(again.counts) <= set(REMEDIES)
    began = again.snapshot().span.began
    assert began == (START if not dropped else stamp if source == "temperature" else None)


def test_a_sample_that_is_no_number_decides_nothing():
    calibration = make_calibration()
    live = started(calibration)
    live.add_temperature(START, 40.0)
    again = started(calibration, file_of(live), max_age=100.0)
    again.add_temperature(0, np.nan)
    again.compensate(*single_sample(0, np.full(6, np.nan)))
    assert again.past is Past.WAITING
    assert again.position is None
    again.add_temperature(START + NANOSECONDS, 40.0)
    assert again.past is Past.TAKEN_UP
    assert again.position is not None


def test_an_accelerometer_that_lags_its_thermistor_is_compared_with_itself():
    calibration = make_calibration()
    live = started(calibration)
    live.add_temperature(START + 30 * NANOSECONDS, 40.0)
    live.compensate(*single_sample(START, np.zeros(6)))
    again = started(calibration, file_of(live), max_age=100.0)
    again.compensate(*single_sample(START + NANOSECONDS, np.zeros(6)))
    assert again.past is Past.TAKEN_UP


def test_the_memory_of_another_sensor_is_dropped():
    live = started(make_calibration(sensor_id="left"))
    live.add_temperature(START, 40.0)
    again = started(make_calibration(sensor_id="right"), file_of(live))
    again.add_temperature(START + 1, 40.0)
    assert again.past is Past.OTHER_SENSOR
    assert list(again.snapshot().remembered[None]) == [(START + 1, 40.0)]


def test_a_state_without_a_calibration_serves_the_one_that_comes_later():
    waiting = LiveCompensation()
    waiting.add_temperature(START, 40.0)
    calibration = make_calibration()
    again = started(calibration, file_of(waiting))
    again.add_temperature(START + NANOSECONDS, 41.0)
    assert again.past is Past.REPLAYED
    there = started(calibration)
    there.add_temperature(START, 40.0)
    there.add_temperature(START + NANOSECONDS, 41.0)
    sample = single_sample(START + 2 * NANOSECONDS, np.zeros(6))
    one, other = (live.compensate(*sample).compensated.drift for live in (again, there))
    assert one.tobytes() == other.tobytes()


def test_a_reset_forgets_the_state_that_waits_as_well():
    calibration = make_calibration()
    live = started(calibration)
    live.add_temperature(START, 40.0)
    again = started(calibration, file_of(live))
    again.reset()
    assert again.position is None
    again.add_temperature(START + NANOSECONDS, 10.0)
    assert again.past is Past.CLEARED
    assert again.snapshot().span.began == START + NANOSECONDS


def test_bad_samples_leave_a_file_that_loads():
    live = started(make_calibration())
    for stamp, value in ((START, 25.0), (START - 1, 25.0), (START + 1, np.nan), (START + 2, 1e300), (START + 3, 26.0)):
        live.add_temperature(stamp, value)
        live.add_temperature_2(stamp, value)
        live.add_supply_voltage(stamp, value)
    again = started(make_calibration(), file_of(live))
    again.add_temperature(START + 4, 26.0)
    assert [list(kept) for kept in again.snapshot().remembered.values()] == [
        [(START, 25.0), (START + 3, 26.0), (START + 4, 26.0)],
        *[[(START, 25.0), (START + 3, 26.0)]] * 2,
    ]


def test_the_file_is_plain_json_with_names_for_people():
    live = started(make_calibration())
    Stream(RECORDING).send(live, 100)
    document = json.loads(file_of(live))
    assert document["format"] == "hgma_state"
    assert document["content"]["calibration_id"] == live.calibration.calibration_id
