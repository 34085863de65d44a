"""A shock keeps peak, width and velocity change, judged against the sensor without a filter."""

from dataclasses import dataclass

import numpy as np
import pytest
from builders import make_stamps

from hgma_compensation.kalman.impulse import LOOK_BACK
from hgma_compensation.kalman.random_walk import RandomWalkNoise
from hgma_compensation.kalman.settings import FilterMode, FilterSettings
from hgma_compensation.kalman.stage import KalmanStage
from hgma_compensation.measured_data import VARIABLE, measured_data

G = 9.80665
PAPER_NOISE = 17130.0 / 3600.0 * G
"""White noise of the paper's sensor, m/s²/√Hz."""

QUIET_NOISE = 0.01 * PAPER_NOISE
SEED = 42
LEAD, TAIL = 2000, 600


@dataclass
class Outcome:
    peak: float
    width: float
    velocity: float


def half_sine(rate, seconds, peak, phase):
    """A half sine of the given peak whose start lies ``phase`` of a sample before a sample."""
    time = (np.arange(int(np.ceil(seconds * rate)) + 1) + phase) / rate
    return np.where(time < seconds, peak * np.sin(np.pi * time / seconds), 0.0)


def run(shock, rate, white, reduction=22.4, mode=FilterMode.SMOOTH, seed=SEED):
    """Relative changes of peak, width and velocity that the stage makes to noisy sensor plus shock."""
    random = np.random.default_rng(seed)
    count = LEAD + len(shock) + TAIL
    raw = white * np.sqrt(rate) * random.standard_normal(count)
    raw[LEAD : LEAD + len(shock)] += shock
    # White noise shrinks by √((2 - K)/K) with K ≈ dt/τ: the paper's reduction at any rate.
    smoothing = 0.5 * (reduction**2 + 1.0) / rate
    noise = RandomWalkNoise.with_time_constant(white, smoothing if mode is FilterMode.SMOOTH else 300.0)
    settings = FilterSettings(mode, noise, initial_bias=0.01 * white)
    stage = KalmanStage(settings, 0.0)
    stamps = make_stamps(np.arange(count) / rate)
    outputs, is_open = np.empty(count), np.empty(count, dtype=bool)
    for k in range(count):
        outputs[k], is_open[k] = stage.run(stamps[k : k + 1], raw[k : k + 1])[0][0], stage.open
    # The event: from LOOK_BACK samples before the opening until the gate closes. In it the sensor without a
    # filter is the truth; its noise in there is not the filter's error, and outside the filter replaces noise.
    opened, closed = (np.flatnonzero(np.diff(is_open.astype(int)) == change) + 1 for change in (1, -1))
    assert LEAD <= opened[0] < LEAD + len(shock)
    event = slice(opened[0] - LOOK_BACK, closed[0])
    top = np.abs(raw).max()
    return Outcome(
        peak=np.abs(outputs).max() / top - 1.0,
        width=(np.abs(outputs) > 0.5 * top).sum() / (np.abs(raw) > 0.5 * top).sum() - 1.0,
        velocity=(outputs - raw)[event].sum() / abs(shock.sum()),
    )


# At 1 MHz a sample of the paper's sensor has 4760 g of noise: a peak of 10 000 g cannot be told there.
@pytest.mark.parametrize("phase", [0.0, 0.3, 0.5, 0.9])
@pytest.mark.parametrize(
    ("rate", "white"),
    [(1e4, QUIET_NOISE), (1e5, QUIET_NOISE), (1e6, QUIET_NOISE), (1e4, PAPER_NOISE), (1e5, PAPER_NOISE)],
)
def test_a_shock_of_one_millisecond_keeps_peak_and_velocity(rate, white, phase):
    shock = half_sine(rate, 1e-3, 10_000.0 * G, phase)
    outcome = run(shock, rate, white)
    assert abs(outcome.peak) < 1e-3
    assert abs(outcome.velocity) < 5e-3
    assert abs(outcome.width) < (1e-9 if white == QUIET_NOISE else 0.25)


@pytest.mark.parametrize("phase", [0.2, 0.5])
@pytest.mark.parametrize("mode", [FilterMode.SMOOTH, FilterMode.BIAS])
def test_one_sample_wide_shocks_pass(mode, phase):
    outcome = run(half_sine(1e4, 1e-4, 100_000.0 * G, phase), 1e4, PAPER_NOISE, mode=mode)
    assert abs(outcome.peak) < 1e-3
    assert abs(outcome.velocity) < 5e-3


def test_bias_mode_passes_a_shock_without_any_change():
    outcome = run(half_sine(1e4, 1e-3, 10_000.0 * G, 0.5), 1e4, PAPER_NOISE, mode=FilterMode.BIAS)
    assert abs(outcome.peak) < 1e-3
    assert outcome.width == 0.0
    assert abs(outcome.velocity) < 5e-3


DATA = measured_data()
TOWER = [] if DATA is None else sorted((DATA / "drop_tower_shock").glob("accel_*.csv"))


@pytest.mark.skipif(not TOWER, reason=f"no measured data: set {VARIABLE} to its folder")
@pytest.mark.parametrize("rate", [1e4, 1e5])
def test_measured_shocks_keep_peak_and_velocity(rate):
    for path in TOWER:
        table = np.genfromtxt(path, delimiter=",", skip_header=1)[:, 1:]
        for column in table.T:
            for white in (QUIET_NOISE, PAPER_NOISE):
                outcome = run(column * 1000.0 * G, rate, white)
                assert abs(outcome.peak) < 1e-3, path.name
                assert abs(outcome.velocity) < 5e-3, path.name
                # At 100 kHz and the paper's noise, half of 11 000 g is 3.6 σ: the gate may open a sample above it.
                assert abs(outcome.width) < (0.02 if (rate, white) == (1e5, PAPER_NOISE) else 1e-9), path.name
