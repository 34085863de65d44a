import numpy as np
import pytest
from builders import LINEAR, make_calibration
from effect_calibrations import OFFERED
from restarts import file_of, started

from hgma_compensation.effects.applied import AppliedEffect
from hgma_compensation.effects.registry import make
from hgma_compensation.pipeline.live_samples import single_sample
from hgma_compensation.pipeline.settling import MemorySpan, unsettled
from hgma_compensation.stamps import NANOSECONDS
from hgma_compensation.temperature.track import Sample

Z = LINEAR[2]
MAP = {"lowest": 0.0, "highest": 50.0, "centres": 0.0}
HYSTERESIS = {"threshold": 5.0, "spread": 1.0, "bend": 0.0, "plays": 1.0, "before": -273.15, "offset": 0.0}


def calibration_with(*effects):
    applied = [AppliedEffect(Z, effect, np.ones(effect.count)) for effect in effects]
    return make_calibration(channels=LINEAR[2:], effects=applied)


@pytest.mark.parametrize(
    ("name", "parameters", "seconds"),
    [
        ("thermal_lag", {"time_constant": 100.0, **MAP, "spread": 4.0, "poles": 2.0}, 600.0),
        ("stress_relaxation", {"time_constant": 1000.0, "spread": 1.0}, 3000.0),
        ("stress_relaxation", {"time_constant": 1000.0, "spread": 3.0}, 9000.0),
        ("warm_up", {"time_constant": 100.0, "spread": 4.0}, 600.0),
        ("timing_offset", {"delay": 12.0, **MAP}, 12.0),
        ("vibration_rectification", {"time_constant": 10.0, "floor": 0.0, "channel": Z}, 30.0),
        ("post_shock_zero_shift", {"threshold": 5.0, "time_constant": 100.0, "channel": Z}, 300.0),
        ("hysteresis", HYSTERESIS, 0.0),
        ("quadratic_nonlinearity", {"channel": Z}, 0.0),
    ],
)
def test_an_effect_settles_in_three_of_its_longest_time_constants(name, parameters, seconds):
    assert make(name, parameters).settling == pytest.approx(seconds)


def test_every_effect_with_a_memory_says_when_it_has_settled():
    for effect in OFFERED[Z]:
        remembers = effect.memory() is not None or effect.acceleration_memory() is not None or effect.history > 0.0
        assert (effect.settling > 0.0 or effect.settling_span > 0.0) == remembers, effect.name


@pytest.mark.parametrize("name", ["thermal_lag", "stress_relaxation"])
def test_after_settling_a_twentieth_of_the_wrong_beginning_is_left(name):
    extra = {**MAP, "poles": 1.0} if name == "thermal_lag" else {}
    effect = make(name, {"time_constant": 600.0, "spread": 1.0, **extra})
    memory = effect.memory()
    states = [memory.start(np.array([celsius])) for celsius in (0.0, 40.0)]
    now = np.array([[20.0]])
    one, other = (memory.advance(s[None], np.array([[effect.settling]]), now, now)[0, 0] for s in states)
    assert abs(other - one) == pytest.approx(40.0 * np.exp(-3.0))


def test_over_twice_its_threshold_a_play_forgets_where_it_stood():
    effect = make("hysteresis", HYSTERESIS)
    memory, random = effect.memory(), np.random.default_rng(1)
    path = np.cumsum(random.uniform(-1.0, 1.0, 400))
    states = [np.array([[path[0] + offset]]) for offset in (-5.0, 5.0)]
    for celsius in path:
        states = [memory.advance(s, np.zeros((1, 1)), None, np.array([[celsius]])) for s in states]
        span = np.ptp(path[: np.flatnonzero(path == celsius)[0] + 1])
        assert (states[0] == states[1]).all() or span < effect.settling_span
    assert (states[0] == states[1]).all()


def test_what_is_left_counts_down_on_the_thermistors_stamps():
    calibration = calibration_with(
        make("stress_relaxation", {"time_constant": 1000.0, "spread": 1.0}), make("hysteresis", HYSTERESIS)
    )
    span = MemorySpan()
    assert unsettled(calibration, span) == []
    span.add(0, 20.0, Sample.USED)
    assert [str(one) for one in unsettled(calibration, span)] == [
        f"stress_relaxation of {Z} for 3000 s more",
        f"hysteresis of {Z} until the temperature has covered 10 °C more",
    ]
    span.add(1000 * NANOSECONDS, 24.0, Sample.USED)
    assert [(one.seconds, one.span) for one in unsettled(calibration, span)] == [(2000.0, 0.0), (0.0, 6.0)]
    span.add(3000 * NANOSECONDS, 14.0, Sample.MOVED)
    assert unsettled(calibration, span) == []


def test_bad_samples_settle_nothing_a_corrected_clock_neither_and_a_new_time_begins_anew():
    span = MemorySpan()
    outcomes = (Sample.USED, Sample.OUT_OF_ORDER, Sample.NOT_FINITE, Sample.IMPLAUSIBLE, Sample.JUMPED, Sample.USED)
    samples = ((10, 20.0), (9, 90.0), (11, np.nan), (12, 1000.0), (12, 90.0), (13, 21.0))
    for (second, celsius), outcome in zip(samples, outcomes, strict=True):
        span.add(second * NANOSECONDS, celsius, outcome)
    assert (span.lowest, span.highest, span.seconds) == (20.0, 21.0, 3.0)
    span.add(5 * NANOSECONDS, 21.0, Sample.SET_BACK)
    span.add(7 * NANOSECONDS, 21.0, Sample.USED)
    assert span.seconds == 5.0
    span.add(1, 5.0, Sample.RESTARTED)
    assert (span.began, span.lowest, span.highest, span.seconds) == (1, 5.0, 5.0, 0.0)


def test_a_memory_that_is_taken_up_has_settled_as_far_as_before_and_a_reset_begins_anew():
    calibration = calibration_with(make("stress_relaxation", {"time_constant": 1000.0, "spread": 1.0}))
    live = started(calibration)
    for second in (1, 2001):
        live.add_temperature(second * NANOSECONDS, 20.0)
    again = started(calibration, file_of(live))
    assert again.unsettled == []
    again.compensate(*single_sample(2001 * NANOSECONDS, np.zeros(6)))
    assert again.unsettled[0].seconds == pytest.approx(1000.0)
    again.add_temperature(3100 * NANOSECONDS, 20.0)
    assert again.unsettled == []
    again.reset()
    again.add_temperature(3101 * NANOSECONDS, 20.0)
    assert again.unsettled[0].seconds == 3000.0
