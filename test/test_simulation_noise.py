from dataclasses import replace

import numpy as np
import pytest
from simulation_scenarios import PARAMS, quiet_scenario

from hgma_compensation.evaluation.allan import FLICKER_FLOOR, AllanCurve, allan_curve, bias_instability
from hgma_compensation.evaluation.allan import velocity_random_walk as read_random_walk
from hgma_compensation.simulation.description import Axis, Oven, Step
from hgma_compensation.simulation.noise import flicker_noise
from hgma_compensation.simulation.oven_test import simulate
from hgma_compensation.simulation.scenario import read_scenario

G_PER_HOUR = 9.80665 / 3600.0
SEEDS = 40
"""One day has 37 clusters of 2325 s, so 40 days give the flat part of the deviation to 2 % (one sigma)."""


@pytest.fixture(scope="module")
def still_curve() -> AllanCurve:
    """Return the Allan deviation of the still sensor, variances averaged over days with different seeds."""
    scenario = read_scenario(PARAMS / "still.yaml")
    recordings = [simulate(replace(scenario, seed=seed)) for seed in range(1, SEEDS + 1)]
    curves = [allan_curve(recording.stamps, recording.values[:, 2]) for recording in recordings]
    return AllanCurve(curves[0].taus, np.sqrt(np.mean([curve.deviations**2 for curve in curves], axis=0)))


def test_the_still_sensor_has_the_white_noise_of_the_paper(still_curve):
    # The flicker noise adds 0.4 % to the deviation at 0.5 s.
    assert read_random_walk(still_curve) / G_PER_HOUR == pytest.approx(17130.0, rel=0.05)


def test_the_still_sensor_has_the_bias_instability_of_the_paper(still_curve):
    assert bias_instability(still_curve) / G_PER_HOUR == pytest.approx(4720.0, rel=0.05)


def test_flicker_noise_has_a_flat_allan_deviation():
    stamps = np.arange(100_000) * 1_000_000_000
    curves = [allan_curve(stamps, flicker_noise(len(stamps), 2.0, np.random.default_rng(seed))) for seed in range(20)]
    deviations = np.sqrt(np.mean([curve.deviations**2 for curve in curves], axis=0))
    flat = (curves[0].taus >= 30.0) & (curves[0].taus <= 1000.0)
    assert deviations[flat] == pytest.approx(2.0 * FLICKER_FLOOR, rel=0.05)


def test_white_noise_is_the_one_asked_for_at_any_rate():
    for rate in (0.5, 8.0):
        axes = {"z": Axis(true_value=9.81, white_noise=46.66)}
        still = Oven(25.0, 30.0, (Step(25.0, 1.0, 100.0),))
        values = simulate(quiet_scenario(axes=axes, oven=still, accelerometer_rate=rate)).values[:, 2]
        assert values.std() == pytest.approx(46.66 * np.sqrt(rate), rel=4.0 / np.sqrt(2.0 * len(values)))
        assert values.mean() == pytest.approx(9.81, abs=4.0 * 46.66 * np.sqrt(rate / len(values)))
