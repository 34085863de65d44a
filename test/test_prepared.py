from dataclasses import replace

import numpy as np
import pytest
from builders import EPOCH, LINEAR, make_calibration
from effect_calibrations import OFFERED, applied, calibrations
from hypothesis import given, settings
from hypothesis import strategies as st
from live_events import EVENTS, outputs

from hgma_compensation.calibration.document import with_id
from hgma_compensation.effects.applied import AppliedEffect
from hgma_compensation.effects.registry import make
from hgma_compensation.kalman.settings import FilterMode
from hgma_compensation.pipeline.live import LiveCompensation
from hgma_compensation.pipeline.live_samples import single_sample
from hgma_compensation.pipeline.prepared import prepare
from hgma_compensation.pipeline.remembered import REMEMBERED
from hgma_compensation.stamps import NANOSECONDS

SHOCKS = make("post_shock_zero_shift", {"threshold": 50.0, "time_constant": 500.0, "channel": LINEAR[2]})


@settings(max_examples=25)
@given(calibrations(), st.integers(0, len(EVENTS) - 1), st.integers(0, 60))
def test_what_was_prepared_away_from_the_stream_is_bit_for_bit_what_was_installed(calibration, begin, taking):
    away, directly = LiveCompensation(), LiveCompensation()
    for live in (away, directly):
        live.install(make_calibration(seed=7, channels=LINEAR))
        outputs(live, EVENTS[:begin])
    prepared = prepare(calibration, away.histories())
    for live in (away, directly):
        outputs(live, EVENTS[begin : begin + taking])
    away.adopt(prepared)
    directly.install(calibration)
    rest = EVENTS[begin + taking :][:200]
    assert outputs(away, rest) == outputs(directly, rest)


@pytest.mark.parametrize("jump_back", [False, True])
def test_a_history_that_began_anew_in_the_meantime_is_not_used(jump_back):
    calibration = make_calibration(seed=2)
    live, fresh = LiveCompensation(), LiveCompensation()
    live.install(make_calibration())
    outputs(live, EVENTS[:300])
    prepared = prepare(calibration, live.histories())
    if not jump_back:
        live.reset()
    stamp = EPOCH - 1000 * NANOSECONDS
    for one in (live, fresh):
        one.add_temperature(stamp, 33.0)
    live.adopt(prepared)
    fresh.install(calibration)
    sample = single_sample(stamp + NANOSECONDS, np.zeros(6))
    one, other = (each.compensate(*sample).compensated for each in (live, fresh))
    assert one.values.tobytes() == other.values.tobytes()
    assert one.features[0, 0] == 33.0


def test_more_samples_in_the_meantime_than_are_kept_are_all_known():
    live, fresh = LiveCompensation(), LiveCompensation()
    prepared = prepare(make_calibration(), live.histories())
    for one in (live, fresh):
        for second in range(REMEMBERED + 100):
            one.add_temperature(second * NANOSECONDS, 20.0 + 0.001 * second)
    live.adopt(prepared)
    fresh.install(make_calibration())
    sample = single_sample((REMEMBERED + 100) * NANOSECONDS, np.zeros(6))
    results = [one.compensate(*sample).compensated for one in (live, fresh)]
    assert results[0].drift.tobytes() == results[1].drift.tobytes()


def test_loading_the_same_calibration_again_changes_no_bit():
    random = np.random.default_rng(5)
    driven = [effect for effect in OFFERED[LINEAR[2]] if effect.acceleration_memory() is not None]
    calibration = make_calibration(effects=[applied(LINEAR[2], effect, random) for effect in driven])
    again, once = LiveCompensation(), LiveCompensation()
    for live in (again, once):
        live.install(calibration)
    parts = []
    for start in range(0, len(EVENTS), 97):
        parts.append(outputs(again, EVENTS[start : start + 97]))
        again.install(calibration)
    assert b"".join(parts) == outputs(once, EVENTS)


def with_shift(gain=0.01, effect=SHOCKS, offset=0.0, twice=False, **options):
    """Return a calibration of z with the zero shift of shocks, its drift model raised by an offset."""
    gains = np.array([gain] + [0.0] * (effect.count - 1))
    calibration = make_calibration(
        channels=LINEAR[2:], effects=[AppliedEffect(LINEAR[2], effect, gains)] * (1 + twice), **options
    )
    channel = calibration.channels[0]
    raised = replace(channel, drift=replace(channel.drift, bias=channel.drift.bias + offset))
    return with_id(replace(calibration, channels=(raised,)))


def run(live, seconds, level, start=EPOCH, shock_at=None):
    """Send a still sensor's samples at 100 Hz, one of them shocked; return the last drift of z."""
    for index in range(int(seconds * 100)):
        values = np.zeros((1, 6))
        values[0, 2] = level + (1000.0 if index == shock_at else 0.0)
        stamp = np.array([start + index * NANOSECONDS // 100])
        drift = live.compensate(stamp, values).compensated.drift[0, 0]
    return drift


def still_level(calibration):
    """Return what the still sensor of a calibration shows at 25 °C, and the drift of its model there."""
    plain = LiveCompensation()
    plain.install(with_id(replace(calibration, effects=())))
    plain.add_temperature(EPOCH, 25.0)
    drift = plain.compensate(*single_sample(EPOCH + NANOSECONDS, np.zeros(6))).compensated.drift[0, 0]
    return drift + calibration.channels[0].reference, drift


def shift_after(second, mode=FilterMode.OFF, seconds=10.0):
    """Return the zero shift that is subtracted once a calibration followed on the one that saw the shock."""
    first = with_shift(mode=mode)
    live, (level, _) = LiveCompensation(), still_level(first)
    live.install(first)
    live.add_temperature(EPOCH, 25.0)
    run(live, 6.0, level, shock_at=200)
    live.install(second)
    return run(live, seconds, level, start=EPOCH + 6 * NANOSECONDS) - still_level(second)[1]


def test_the_zero_shift_that_a_shock_left_outlives_a_new_calibration():
    assert shift_after(with_shift()) == pytest.approx(10.0, rel=1e-3)
    assert shift_after(with_shift(mode=FilterMode.SMOOTH)) == pytest.approx(10.0, rel=1e-3)
    assert shift_after(with_shift(gain=0.02, seed=9)) == pytest.approx(20.0, rel=1e-3)
    assert shift_after(with_shift(twice=True)) == pytest.approx(10.0, rel=1e-3)


def test_an_effect_with_other_parameters_begins_without_a_past():
    other = make("post_shock_zero_shift", {"threshold": 50.0, "time_constant": 501.0, "channel": LINEAR[2]})
    assert shift_after(with_shift(effect=other)) == 0.0


@pytest.mark.parametrize("seconds", [0.01, 1.0, 10.0])
def test_another_drift_model_is_not_taken_for_a_shock(seconds):
    assert shift_after(with_shift(offset=300.0), seconds=seconds) == pytest.approx(10.0, rel=1e-2)
    assert shift_after(with_shift(offset=-300.0), seconds=seconds) == pytest.approx(10.0, rel=1e-2)
