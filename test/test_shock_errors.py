from dataclasses import replace

import numpy as np
import pytest
from builders import make_calibration

from hgma_compensation.evaluation.measured_shocks import measured_shocks
from hgma_compensation.evaluation.shock import StillSensor, half_sine, shock_errors, width_at_half_height
from hgma_compensation.kalman.random_walk import RandomWalkNoise
from hgma_compensation.kalman.settings import FilterMode, FilterSettings
from hgma_compensation.measured_data import VARIABLE

RATE = 10_000.0


def calibration(mode, seconds=1.0, threshold=None):
    made = make_calibration(channels=("linear_acceleration.z",))
    settings = FilterSettings()
    if mode is not FilterMode.OFF:
        settings = FilterSettings(mode, RandomWalkNoise.with_time_constant(white=46.7, seconds=seconds))
    if threshold is not None:
        settings = replace(settings, threshold=threshold)
    return replace(made, channels=(replace(made.channels[0], filter=settings),))


def test_the_half_sine_has_its_peak_and_width():
    shock = half_sine(1e6, seconds=1e-3, peak=5.0)
    assert shock.max() == pytest.approx(5.0)
    assert shock[[0, -1]] == pytest.approx(0.0, abs=1e-12)
    assert width_at_half_height(shock) == pytest.approx(1000.0 * 2.0 / 3.0, rel=1e-3)


@pytest.mark.parametrize(
    ("pulse", "width"),
    [([0.0, 2.0, 4.0, 2.0, 0.0], 2.0), ([0.0, -4.0, -4.0, 0.0], 2.0), ([4.0, 0.0], 0.5), ([0.0, 4.0], None)],
)
def test_width_at_half_height(pulse, width):
    assert width_at_half_height(np.array(pulse)) == (None if width is None else pytest.approx(width))


def test_without_a_filter_a_shock_keeps_everything():
    errors = shock_errors(calibration(FilterMode.OFF), RATE, sensor=StillSensor(white_noise=46.7))
    assert (errors.peak, errors.width, errors.velocity_change) == pytest.approx((0.0, 0.0, 0.0), abs=1e-9)


def test_a_filter_whose_gate_never_opens_takes_the_shock_away():
    errors = shock_errors(calibration(FilterMode.SMOOTH, threshold=1e9), RATE)
    assert errors.peak < -0.9


@pytest.mark.parametrize("mode", [FilterMode.SMOOTH, FilterMode.BIAS])
def test_the_gate_lets_the_shock_through(mode):
    errors = shock_errors(calibration(mode), RATE)
    assert (errors.peak, errors.width, errors.velocity_change) == pytest.approx((0.0, 0.0, 0.0), abs=0.01)


def test_measured_shocks_are_read_in_si_units(tmp_path, monkeypatch):
    monkeypatch.setenv(VARIABLE, str(tmp_path))
    assert measured_shocks() == {}
    folder = tmp_path / "drop_tower_shock"
    folder.mkdir()
    (folder / "accel_5.csv").write_text("t_s,test1_kg,test2_kg\n0,0.5,-2\n1e-06,1,0\n")
    shocks = measured_shocks()
    assert list(shocks) == ["accel_5 test1", "accel_5 test2"]
    assert shocks["accel_5 test2"] == pytest.approx([-2000.0 * 9.80665, 0.0])
