import json
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from builders import LINEAR, make_calibration, make_stamps
from effect_calibrations import OFFERED, applied, calibrations, switched_off, with_all_inputs
from hypothesis import given, settings
from hypothesis import strategies as st

from hgma_compensation.channels import columns_of
from hgma_compensation.effects.applied import AppliedEffect
from hgma_compensation.effects.registry import make
from hgma_compensation.errors import RefusedError
from hgma_compensation.kalman.settings import FilterMode
from hgma_compensation.pipeline.compensated import Compensated, joined
from hgma_compensation.pipeline.pipeline import Pipeline
from hgma_compensation.pipeline.stretches import Cut
from hgma_compensation.recording.compensated_bag import check_covered, compensate_recording, feed
from hgma_compensation.recording.recording import Recording, Series
from hgma_compensation.stamps import to_nanoseconds

RECORDING = with_all_inputs()
STAMPS = RECORDING.stamps
SWITCHED_OFF = switched_off(RECORDING)


def assert_same_bits(one, other, names=tuple(Compensated.FIELDS)):
    for name in names:
        assert getattr(one, name).tobytes() == getattr(other, name).tobytes(), name


def compensate(pipeline, rows, recording=RECORDING):
    values = recording.values[rows]
    return pipeline.compensate(recording.stamps[rows], values[:, columns_of(pipeline.calibration.names)], values)


def arrivals(recording=RECORDING):
    """Return all slow samples as (stamp, method of the pipeline, value), in the order of their stamps."""
    inputs = {
        "add_temperature": recording.temperature,
        "add_temperature_2": recording.temperature_2,
        "add_supply_voltage": recording.supply_voltage,
    }
    return sorted(
        (stamp, name, value)
        for name, series in inputs.items()
        for stamp, value in zip(series.stamps.tolist(), series.values.tolist(), strict=True)
    )


def streamed(calibration, lateness, random, recording=RECORDING):
    """Return the parts that a live pipeline gives, in blocks of random length, slow samples being late at random."""
    pipeline, waiting = Pipeline(calibration, live=True), arrivals(recording)
    row, parts = 0, []
    while row < len(recording.stamps):
        stop = min(row + int(random.choice([1, 1, 2, 7, 40])), len(recording.stamps))
        arrived = recording.stamps[stop - 1] - (lateness * random.random() if parts else 0)
        while waiting and waiting[0][0] <= arrived:
            stamp, name, value = waiting.pop(0)
            getattr(pipeline, name)(stamp, value)
        parts.append(compensate(pipeline, slice(row, stop), recording))
        row = stop
    return parts


@settings(max_examples=60)
@given(calibration=calibrations(), seed=st.integers(0, 2**32 - 1))
def test_a_stream_gives_the_bits_of_the_batch(calibration, seed):
    latency = to_nanoseconds(calibration.features.latency)
    parts = streamed(calibration, 0.99 * latency, np.random.default_rng(seed))
    batch = compensate_recording(RECORDING, calibration)
    assert np.isfinite(batch.values).all()
    assert_same_bits(joined(parts), batch)


@settings(max_examples=30)
@given(calibration=calibrations(), seed=st.integers(0, 2**32 - 1))
def test_a_stream_gives_the_bits_of_the_batch_after_a_power_on_too(calibration, seed):
    parts = streamed(calibration, 0.0, np.random.default_rng(seed), SWITCHED_OFF)
    assert_same_bits(joined(parts), compensate_recording(SWITCHED_OFF, calibration))


@settings(max_examples=30)
@given(calibration=calibrations(), cuts=st.lists(st.integers(0, len(STAMPS)), max_size=8))
def test_any_split_gives_the_bits_of_the_batch(calibration, cuts):
    pipeline = Pipeline(calibration)
    feed(pipeline, RECORDING)
    edges = [0, *sorted(cuts), len(STAMPS)]
    parts = [compensate(pipeline, slice(a, b)) for a, b in pairwise(edges)]
    assert_same_bits(joined(parts), compensate_recording(RECORDING, calibration))


@settings(max_examples=20)
@given(calibration=calibrations())
def test_a_looping_bag_gives_the_same_output_each_time(calibration):
    pipeline = Pipeline(calibration, live=True)
    rounds = []
    for _ in range(3):
        feed(pipeline, RECORDING)
        rounds.append(compensate(pipeline, slice(None)))
    assert pipeline.cuts == {Cut.ANEW: 2}
    assert_same_bits(rounds[1], rounds[0])
    assert_same_bits(rounds[2], rounds[0])
    pipeline.reset()
    feed(pipeline, RECORDING)
    assert_same_bits(compensate(pipeline, slice(None)), rounds[0])


@pytest.mark.parametrize("number", range(len(OFFERED[LINEAR[2]])), ids=lambda n: OFFERED[LINEAR[2]][n].name)
def test_every_effect_runs_alone_sample_by_sample(number):
    effect = applied(LINEAR[2], OFFERED[LINEAR[2]][number], np.random.default_rng(number))
    calibration = make_calibration(channels=LINEAR[2:], effects=[effect])
    stream = Pipeline(calibration, live=True)
    feed(stream, RECORDING)
    parts = [compensate(stream, slice(row, row + 1)) for row in range(0, len(STAMPS))]
    batch = compensate_recording(RECORDING, calibration)
    assert_same_bits(joined(parts), batch)
    plain = compensate_recording(RECORDING, make_calibration(channels=LINEAR[2:]))
    assert np.any(batch.drift != plain.drift)


def test_effects_are_subtracted_beside_the_drift_model_and_before_the_filter():
    effects = [applied(LINEAR[0], OFFERED[LINEAR[0]][0], np.random.default_rng(1))]
    plain, with_effect = (
        compensate_recording(RECORDING, make_calibration(mode=FilterMode.SMOOTH, effects=some))
        for some in ((), effects)
    )
    assert np.all((plain.drift != with_effect.drift).any(axis=0) == [True, False, False])
    assert np.any(plain.innovation[:, 0] != with_effect.innovation[:, 0])


def test_inputs_that_have_not_come_leave_their_effects_out():
    effects = [
        applied(LINEAR[2], effect, np.random.default_rng(2))
        for effect in OFFERED[LINEAR[2]]
        if effect.name in ("thermal_gradient", "supply_voltage")
    ]
    calibration = make_calibration(channels=LINEAR[2:], effects=effects)
    bare = replace(RECORDING, temperature_2=Series.empty(), supply_voltage=Series.empty())
    plain = compensate_recording(RECORDING, make_calibration(channels=LINEAR[2:]))
    assert_same_bits(compensate_recording(bare, calibration), plain)
    drift = compensate_recording(RECORDING, calibration).drift
    changed = np.flatnonzero((drift != plain.drift).any(axis=1))[0]
    latency = to_nanoseconds(calibration.features.latency)
    first = min(RECORDING.temperature_2.stamps[0], RECORDING.supply_voltage.stamps[0]) + latency
    assert changed == np.searchsorted(STAMPS, first)


def interrupted(calibration, row, recording=RECORDING):
    """Return the drift of a run whose pipeline was stored and restored before a row."""
    waiting, parts = arrivals(recording), []
    pipeline = Pipeline(calibration, live=True)
    for rows in (slice(0, row), slice(row, len(recording.stamps))):
        last = recording.stamps[rows][-1] if rows.stop > rows.start else 0
        while waiting and waiting[0][0] <= last:
            stamp, name, value = waiting.pop(0)
            getattr(pipeline, name)(stamp, value)
        parts.append(compensate(pipeline, rows, recording).drift)
        restored = Pipeline(calibration, live=True)
        restored.restore(json_round_trip(pipeline.snapshot()))
        pipeline = restored
    return np.concatenate(parts)


def json_round_trip(document):
    return json.loads(json.dumps(document, allow_nan=False))


@pytest.mark.parametrize("recording", [RECORDING, SWITCHED_OFF], ids=["on", "switched off"])
@settings(max_examples=25)
@given(calibration=calibrations(modes=(FilterMode.OFF,)), row=st.integers(0, len(STAMPS)))
def test_a_restored_pipeline_goes_on_with_the_bits_of_one_never_interrupted(recording, calibration, row):
    expected = compensate_recording(recording, calibration).drift
    assert interrupted(calibration, row, recording).tobytes() == expected.tobytes()


@pytest.mark.parametrize(
    "change",
    [
        lambda snapshot: snapshot.update(calibration_id="sha256-0000000000000000"),
        lambda snapshot: snapshot.pop("inputs"),
        lambda snapshot: snapshot.update(effects=[]),
        lambda snapshot: snapshot.update(stretches=["yesterday", 3]),
        lambda snapshot: snapshot["inputs"]["temperature"]["updates"].update(values=[[1.0]]),
        lambda snapshot: snapshot["inputs"]["temperature"].update(filter=[1.0]),
        lambda snapshot: snapshot["inputs"]["temperature"]["updates"]["stamps"].reverse(),
        lambda snapshot: snapshot["inputs"]["temperature"]["updates"]["values"][3].__setitem__(0, float("nan")),
    ],
)
def test_a_snapshot_that_does_not_fit_is_refused_and_nothing_of_it_stays(change):
    effects = {effect.name: effect for effect in OFFERED[LINEAR[2]]}
    wanted = [
        applied(LINEAR[2], effects[n], np.random.default_rng(1)) for n in ("thermal_lag", "post_shock_zero_shift")
    ]
    calibration = make_calibration(effects=wanted)
    pipeline, other = Pipeline(calibration), Pipeline(calibration)
    feed(pipeline, RECORDING)
    compensate(pipeline, slice(None))
    snapshot = pipeline.snapshot()
    change(snapshot)
    with pytest.raises(RefusedError, match=r"snapshot .*: start without it"):
        other.restore(snapshot)
    feed(other, RECORDING)
    assert_same_bits(compensate(other, slice(None)), compensate_recording(RECORDING, calibration))


def test_switched_off_and_on_again_it_warms_up_anew_and_still_remembers_its_temperatures():
    effects = [
        AppliedEffect(LINEAR[2], make("warm_up", {"time_constant": 100.0, "spread": 1.0}), np.array([2.0])),
        AppliedEffect(LINEAR[2], make("stress_relaxation", {"time_constant": 3000.0, "spread": 1.0}), np.ones(1)),
    ]
    warm_up, creep = (make_calibration(channels=LINEAR[2:], effects=[effect]) for effect in effects)
    # Off for twelve time constants, after which the sensor is cold.
    seconds = np.concatenate([np.arange(0.0, 300.0), np.arange(1500.0, 1800.0)])
    temperature = Series(make_stamps(seconds), np.where(seconds < 900.0, 0.0, 50.0))
    still = Recording(
        "off and on", make_stamps(np.array([250.0, 1501.0, 1750.0])), np.zeros((3, 6)), LINEAR[2:], temperature
    )
    plain = compensate_recording(still, make_calibration(channels=LINEAR[2:])).drift[:, 0]
    warming = compensate_recording(still, warm_up).drift[:, 0] - plain
    np.testing.assert_allclose(warming, 2.0 * np.exp(-np.array([250.0, 1.0, 250.0]) / 100.0), rtol=1e-4)
    # The temperature is taken to have gone evenly through the pause.
    creeping = compensate_recording(still, creep).drift[:, 0] - plain
    pause = 1500.0 - 299.0
    behind = 50.0 / pause * 3000.0 * (1.0 - np.exp(-pause / 3000.0))
    np.testing.assert_allclose(creeping[2], behind * np.exp(-250.0 / 3000.0), rtol=0.01)


def test_an_effect_of_a_channel_without_calibration_needs_all_channels():
    effect = AppliedEffect(LINEAR[2], make("cross_axis", {"source": LINEAR[0]}), np.array([0.5]))
    pipeline = Pipeline(make_calibration(channels=LINEAR[2:], effects=[effect]))
    with pytest.raises(ValueError, match=r"need imu: they read linear_acceleration\.x"):
        pipeline.compensate(STAMPS[:1], np.zeros((1, 1)))
    values = np.array([[8.0, 0.0, 0.0, 0.0, 0.0, 0.0]])
    with_source = pipeline.compensate(STAMPS[:1], values[:, 2:3], values)
    plain = Pipeline(make_calibration(channels=LINEAR[2:])).compensate(STAMPS[:1], values[:, 2:3])
    np.testing.assert_allclose(with_source.drift - plain.drift, [[4.0]], rtol=1e-12)


def test_a_recording_without_an_input_that_an_effect_needs_is_refused_with_topic_and_remedy():
    needs = {
        "thermal_gradient": (replace(RECORDING, temperature_2=Series.empty()), "/accel/temperature_2"),
        "supply_voltage": (replace(RECORDING, supply_voltage=Series.empty()), "/accel/supply_voltage"),
        "cross_axis": (replace(RECORDING, present=(LINEAR[2],)), "channel linear_acceleration.x"),
    }
    effects = {effect.name: effect for effect in OFFERED[LINEAR[2]]}
    effects["cross_axis"] = make("cross_axis", {"source": LINEAR[0]})
    for name, (lacking, what) in needs.items():
        effect = applied(LINEAR[2], effects[name], np.random.default_rng(1))
        calibration = make_calibration(channels=LINEAR[2:], effects=[effect])
        check_covered(RECORDING, calibration)
        with pytest.raises(RefusedError, match=f"{what}, which the effect {name} .* use a calibration without"):
            check_covered(lacking, calibration)
