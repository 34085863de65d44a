"""Recordings with every input, and effects of every kind on them."""

from dataclasses import replace

import numpy as np
from builders import EPOCH, LINEAR, make_calibration, make_recording, make_stamps
from hypothesis import strategies as st

from hgma_compensation.effects.applied import AppliedEffect
from hgma_compensation.effects.effect import Survey
from hgma_compensation.effects.registry import kinds
from hgma_compensation.kalman.settings import FilterMode
from hgma_compensation.recording.recording import Series
from hgma_compensation.stamps import to_nanoseconds

PERIODIC = kinds()["periodic_interference"](period=7.0, origin=float(EPOCH))


def survey_of(channel):
    """Return what the recording below spans, as a diagnosis would."""
    others = tuple(other for other in (*LINEAR, "angular_velocity.x") if other != channel)
    return Survey(channel, others, -10.0, 60.0, 60.0, 0.1, 2.0, 0.05, EPOCH, 5.0)


def offered(channel):
    """Return effects on a channel: of each kind a few candidates, and the richer forms of the last."""
    found = [PERIODIC]
    for kind in kinds().values():
        candidates = list(kind.candidates(survey_of(channel)))[::5]
        found += candidates + [
            richer for candidate in candidates[-1:] for richer in candidate.richer(survey_of(channel))
        ]
    return found


OFFERED = {channel: offered(channel) for channel in LINEAR}


def applied(channel, effect, random):
    """Return an effect with random gains that make its drift neither vanish nor run away."""
    size = 1e-4 if effect.per_sample else 0.05
    return AppliedEffect(channel, effect, size * random.standard_normal(effect.count))


@st.composite
def calibrations(draw, modes=tuple(FilterMode)):
    """Calibrations of two axes with up to six effects on them."""
    random = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    channels = LINEAR[1:]
    effects = []
    for _ in range(draw(st.integers(1, 6))):
        channel = draw(st.sampled_from(channels))
        effects.append(applied(channel, draw(st.sampled_from(OFFERED[channel])), random))
    return make_calibration(
        draw(st.integers(1, 5)), channels=channels, mode=draw(st.sampled_from(modes)), effects=effects
    )


def with_all_inputs(seed=3, duration_s=60.0, **options):
    """Return a recording with second thermometer, supply voltage, shocks, vibration, and a thermistor that pauses."""
    random = np.random.default_rng(seed)
    recording = make_recording(
        seed,
        duration_s,
        accel_rate=10.0,
        thermistor_rate=2.0,
        cycles=1.0,
        channels=(*LINEAR, "angular_velocity.x"),
        **options,
    )
    values = recording.values.copy()
    rows = len(values)
    values[random.integers(0, rows, 4), 2] += 40.0
    values[rows // 3 : rows // 2, 1] += random.standard_normal(rows // 2 - rows // 3)
    return replace(
        recording,
        values=values,
        temperature_2=_series(random, 0.03 * duration_s, duration_s, 0.7, 20.0),
        supply_voltage=_series(random, 0.05 * duration_s, duration_s, 1.3, 5.0),
    )


def _series(random, start, end, interval, level):
    stamps = make_stamps(np.arange(start, end, interval) + 0.2 * random.random())
    values = level + np.cumsum(0.05 * random.standard_normal(len(stamps)))
    values[len(values) // 2] = np.nan
    return Series(stamps, values)


def switched_off(recording, seconds=200.0, late=1.5):
    """Return the recording with a pause of everything in its middle, the thermistor beginning late after it."""
    middle = recording.stamps[len(recording.stamps) // 2]
    pause, delay = to_nanoseconds(seconds), to_nanoseconds(late)

    def paused(series, late=0):
        kept = (series.stamps < middle) | (series.stamps >= middle + late)
        stamps = series.stamps[kept]
        return Series(stamps + np.where(stamps >= middle, pause, 0), series.values[kept])

    return replace(
        recording,
        stamps=recording.stamps + np.where(recording.stamps >= middle, pause, 0),
        temperature=paused(recording.temperature, delay),
        temperature_2=paused(recording.temperature_2),
        supply_voltage=paused(recording.supply_voltage),
    )
