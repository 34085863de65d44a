"""A sensor that its calibration no longer describes is noticed at rest, and one that it describes is left alone."""

from types import SimpleNamespace

import numpy as np
import pytest
from builders import EPOCH, LINEAR, make_calibration, make_recording

from hgma_compensation.kalman.settings import FilterMode
from hgma_compensation.pipeline.live import LiveCompensation
from hgma_compensation.pipeline.live_samples import single_sample
from hgma_compensation.pipeline.rest_monitor import LEAST_BLOCKS, RestMonitor
from hgma_compensation.stamps import NANOSECONDS
from hgma_compensation.training.methods import Method
from hgma_compensation.training.train import TrainingOptions, train

Z = LINEAR[2:]


def recorded(seed, span=50.0, **options):
    return make_recording(
        seed, duration_s=3600.0, accel_rate=5.0, thermistor_rate=1.0, cycles=3.0, span=span, **options
    )


@pytest.fixture(scope="module")
def trained():
    """A calibration with a Kalman stage, trained on a sensor that drifts by 50/3 m/s² in z over its range."""
    options = TrainingOptions(method=Method.POLYNOMIAL, channels=Z, delay=10.0, filter=FilterMode.SMOOTH)
    return train([recorded(1)], options)


def run(calibration, recording):
    live = LiveCompensation()
    live.install(calibration)
    slow = iter(zip(recording.temperature.stamps.tolist(), recording.temperature.values.tolist(), strict=True))
    waiting = next(slow)
    found = []
    for row, stamp in enumerate(recording.stamps.tolist()):
        while waiting is not None and waiting[0] <= stamp:
            live.add_temperature(*waiting)
            waiting = next(slow, None)
        live.compensate(*single_sample(stamp, recording.values[row].tolist()))
        if row % 50 == 49:
            found += live.observer.problems()
    return live, found


def test_the_sensor_it_was_trained_on_fits(trained):
    live, found = run(trained, recorded(2))
    assert not found
    values = dict(live.observer.values())
    assert 0.5 < float(values["nis_linear_acceleration.z"]) < 2.0
    own = float(values["calibration_error_linear_acceleration.z"])
    assert 0.0 < float(values["rest_residual_linear_acceleration.z"]) < 2.0 * own


def test_a_sensor_that_drifts_otherwise_is_noticed_and_diagnose_is_named(trained):
    _, found = run(trained, recorded(2, span=40.0))
    assert any("no longer fits" in problem and "hgma diagnose" in problem for problem in found)


def test_a_level_that_no_tilt_explains_is_noticed(trained):
    _, found = run(trained, recorded(2, still=9.81 + 25.0))
    assert any("no longer fits" in problem for problem in found)


def test_a_sensor_that_is_turned_over_still_fits(trained):
    _, found = run(trained, recorded(2, still=-9.81))
    assert not any("no longer fits" in problem for problem in found)


def test_a_sensor_that_has_lost_its_noise_is_told_by_its_innovations(trained):
    _, found = run(trained, recorded(2, noise=0.05 / 4.0))
    assert any("the noise of linear_acceleration.z" in problem for problem in found)


def test_a_noisier_sensor_keeps_the_gate_open(trained):
    quiet, _ = run(trained, recorded(2))
    noisy, _ = run(trained, recorded(2, noise=0.05 * 3.0))
    fractions = [float(dict(live.observer.values())["gate_open_linear_acceleration.z"]) for live in (quiet, noisy)]
    assert fractions[0] < 0.01
    assert fractions[1] > 0.8


def monitored(residual, temperature, *, usable=True, noise=0.0):
    """Return a monitor that has seen a residual (n,) once in 0.5 s."""
    calibration = make_calibration(channels=Z)
    random = np.random.default_rng(3)
    monitor = RestMonitor(calibration)
    corrected = (calibration.channels[0].reference + residual + noise * random.standard_normal(len(residual)))[:, None]
    for row, (value, celsius) in enumerate(zip(corrected, temperature, strict=True)):
        stamp = np.array([EPOCH + row * NANOSECONDS // 2])
        monitor.take(stamp, value[None], SimpleNamespace(features=np.array([[celsius, 0.0, 0.0]])), usable)
    return monitor.residuals()


COUNT = 20 * LEAST_BLOCKS
WARMING = np.linspace(20.0, 30.0, COUNT)


def test_nothing_is_said_before_there_is_enough_or_while_the_temperature_is_unusable():
    assert not monitored(np.zeros(200), WARMING[:200])
    assert not monitored(np.zeros(COUNT), WARMING, usable=False)
    assert monitored(np.zeros(COUNT), WARMING)[0].fits


def test_drift_counts_only_while_the_temperature_changes():
    drifting = 0.1 * (WARMING - 20.0) * 3.0
    assert not monitored(drifting, WARMING)[0].fits
    assert monitored(drifting, np.full(COUNT, 20.0))[0].fits


def test_motion_is_not_judged():
    assert not monitored(np.zeros(COUNT), WARMING, noise=30.0)


def test_a_new_position_begins_anew():
    tilted = np.where(np.arange(COUNT) < COUNT - 100, 0.0, 9.0)
    assert not monitored(tilted, WARMING)
