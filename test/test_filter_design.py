from math import sqrt

import numpy as np
import pytest
from builders import make_stamps

from hgma_compensation.errors import RefusedError
from hgma_compensation.kalman.course import filter_samples
from hgma_compensation.kalman.design import reference_filter, settled_filter
from hgma_compensation.kalman.random_walk import RandomWalkNoise
from hgma_compensation.kalman.settings import FilterMode
from hgma_compensation.training.filter_design import design_filter

NOISE = RandomWalkNoise(white=0.2, walk=0.4)
INTERVAL = 0.05
SEED = 31


def test_the_stage_equals_the_reference_design_step_by_step():
    values = np.random.default_rng(SEED).normal(9.81, 1.0, 200)
    stamps = make_stamps(np.arange(200) * INTERVAL)
    estimates, innovations = filter_samples(NOISE, stamps, values)
    reference = reference_filter(NOISE, INTERVAL, values[0])
    expected = []
    for value in values[1:]:
        reference.predict()
        reference.update(np.array([[value]]))
        expected.append((reference.x[0, 0], reference.y[0, 0]))
    np.testing.assert_allclose(estimates[1:], [x for x, _ in expected], rtol=1e-12)
    np.testing.assert_allclose(innovations[1:], [y for _, y in expected], atol=1e-11)


def test_the_settled_gain_solves_the_riccati_equation():
    settled = settled_filter(NOISE, INTERVAL)
    q, r = NOISE.walk**2 * INTERVAL, NOISE.white**2 / INTERVAL
    predicted = 0.5 * (q + sqrt(q * q + 4.0 * q * r))
    assert settled.gain == pytest.approx(predicted / (predicted + r), rel=1e-9)


def test_white_noise_shrinks_by_the_factor_that_is_promised():
    settled = settled_filter(NOISE, INTERVAL)
    noise = np.random.default_rng(SEED).standard_normal(100_000)
    stamps = make_stamps(np.arange(len(noise)) * INTERVAL)
    estimates, _ = filter_samples(NOISE, stamps, noise)
    reduction = noise.std() / estimates[1000:].std()
    # The output is correlated over 2 τ: so many fewer independent values stand behind its deviation.
    independent = len(noise) * INTERVAL / (2.0 * settled.time_constant)
    assert reduction == pytest.approx(settled.noise_reduction, rel=4.0 / sqrt(2.0 * independent))


def test_the_time_constant_is_the_one_asked_for():
    noise = RandomWalkNoise.with_time_constant(white=0.2, seconds=5.0)
    assert settled_filter(noise, INTERVAL).time_constant == pytest.approx(5.0, rel=INTERVAL / 5.0)


def test_a_filter_that_would_do_nothing_is_refused():
    values = np.random.default_rng(SEED).standard_normal(1000)
    stamps = make_stamps(np.arange(1000) * INTERVAL)
    with pytest.raises(RefusedError, match=r"longer --filter-time-constant"):
        design_filter(FilterMode.SMOOTH, 0.01, stamps, values, "linear_acceleration.z", error=0.1, block=5.0)
    with pytest.raises(RefusedError, match="has no noise"):
        design_filter(FilterMode.SMOOTH, 1.0, stamps, np.zeros(1000), "linear_acceleration.z", error=0.1, block=5.0)
    assert (
        design_filter(FilterMode.OFF, 0.01, stamps, values, "linear_acceleration.z", error=0.1, block=5.0).noise is None
    )
