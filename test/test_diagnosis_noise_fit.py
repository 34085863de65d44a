import numpy as np
import pytest
from builders import make_recording
from diagnosis_blocks import flicker_covariance, make_blocks_of
from scipy.linalg import toeplitz

from hgma_compensation.diagnosis.noise_fit import fit_noise, quiet_level, thermistor_error, white_variance
from hgma_compensation.diagnosis.runs import make_run
from hgma_compensation.diagnosis.smoothing import smooth
from hgma_compensation.temperature.trend_filter import TrendNoise

BLOCK, COUNT = 10.0, 1200
NO_CORRELATION = np.array([1.0, 0.0])


def drifting(white, flicker, seed):
    """Return blocks of noise on a slow drift, what is left of them beside the drift, and the drift's columns."""
    random = np.random.default_rng(seed)
    covariance = flicker_covariance(COUNT, BLOCK, flicker) + white * np.eye(COUNT)
    noise = np.linalg.cholesky(covariance) @ random.standard_normal(COUNT)
    time = np.linspace(-1.0, 1.0, COUNT)
    nuisance = np.column_stack([time**k for k in range(5)])
    values = noise + nuisance @ np.array([3.0, 40.0, -20.0, 10.0, 5.0])
    left = values - nuisance @ np.linalg.lstsq(nuisance, values, rcond=None)[0]
    return make_blocks_of(values, BLOCK, white), left, nuisance


@pytest.mark.parametrize(("white", "flicker"), [(1.0, 0.3), (4.0, 0.8), (0.01, 0.005)])
@pytest.mark.parametrize("seed", [1])
def test_white_and_flicker_are_found(white, flicker, seed):
    blocks, left, nuisance = drifting(white, flicker, seed)
    found = fit_noise(blocks, left, nuisance, (np.zeros(COUNT), NO_CORRELATION), BLOCK)
    # What flickers from block to block counts as white.
    assert 0.8 < np.median(found.white) / white < 1.8
    assert 0.4 < found.flicker / flicker < 2.0
    whitener = found.whitener(blocks.run, blocks.stamps)
    q, _ = np.linalg.qr(whitener(nuisance))
    rest = whitener(left)
    rest = rest - q @ (q.T @ rest)
    assert np.mean(rest**2) == pytest.approx(1.0, abs=0.2)


def test_white_noise_alone_has_next_to_no_flicker():
    blocks, left, nuisance = drifting(1.0, 0.0, 3)
    found = fit_noise(blocks, left, nuisance, (np.zeros(COUNT), NO_CORRELATION), BLOCK)
    assert found.flicker < 0.02
    assert np.median(found.white) == pytest.approx(1.0, rel=0.1)


def test_what_the_thermistor_brings_is_not_counted_as_white_noise():
    blocks, left, _ = drifting(1.0, 0.0, 4)
    both = left + 2.0 * np.random.default_rng(5).standard_normal(COUNT)
    carried = np.full(COUNT, 2.0)
    assert np.median(white_variance(blocks, both, carried)) == pytest.approx(1.0, rel=0.35)
    assert np.median(white_variance(blocks, both, 0.0 * carried)) == pytest.approx(5.0, rel=0.15)


def test_blocks_that_vibrate_count_with_their_own_noise():
    blocks, left, _ = drifting(1.0, 0.0, 6)
    shaken = np.zeros(COUNT, dtype=bool)
    shaken[100:300] = True
    blocks.white[shaken] = 100.0
    left[shaken] *= 10.0
    white = white_variance(blocks, left, np.zeros(COUNT))
    np.testing.assert_allclose(white[~shaken], 1.0, rtol=0.15)
    np.testing.assert_allclose(white[shaken], 100.0, rtol=0.15)


def test_the_quiet_level_is_that_of_blocks_in_which_nothing_vibrates():
    random = np.random.default_rng(7)
    quiet, shaken = random.uniform(0.9, 1.1, 300), random.uniform(500.0, 600.0, 700)
    assert quiet_level(np.concatenate([quiet, shaken])) == pytest.approx(1.0, rel=0.05)
    assert quiet_level(quiet) == pytest.approx(1.0, rel=0.02)


def test_the_thermistors_error_is_that_of_smoothed_noise():
    recording = make_recording(duration_s=120.0, thermistor_rate=1.0)
    noise = TrendNoise(process=3e-6, measurement=9e-4)
    error = thermistor_error(make_run(recording, noise), noise, BLOCK, np.random.default_rng(1))
    random = np.random.default_rng(99)
    stamps = np.arange(20000, dtype=np.int64) * 1_000_000_000
    smoothed = smooth(stamps, 0.03 * random.standard_normal(20000), noise).temperature
    means = smoothed.reshape(-1, 10).mean(axis=1)[5:-5]
    assert error.deviation == pytest.approx(means.std(), rel=0.1)
    assert error.deviation < 0.03 / np.sqrt(10.0)
    lagged = np.array([means[k:] @ means[: len(means) - k] / (len(means) - k) for k in (0, 1)])
    assert error.correlation[0] == 1.0
    assert error.correlation[1] == pytest.approx(lagged[1] / lagged[0], abs=0.12)
    assert np.linalg.eigvalsh(toeplitz(np.append(error.correlation, np.zeros(100)))).min() > -1e-3


def test_twice_the_thermistors_noise_is_twice_the_error():
    recording = make_recording(duration_s=120.0, thermistor_rate=1.0)
    errors = []
    for factor in (1.0, 4.0):
        noise = TrendNoise(process=factor * 1e-6, measurement=factor * 4e-4)
        run = make_run(recording, noise)
        errors.append(thermistor_error(run, noise, BLOCK, np.random.default_rng(1)).deviation)
    assert errors[1] == pytest.approx(2.0 * errors[0], rel=1e-6)
