from dataclasses import replace

import numpy as np
import pytest
from builders import make_recording, make_stamps
from hypothesis import given
from hypothesis import strategies as st

from hgma_compensation.errors import RefusedError
from hgma_compensation.recording.recording import Series
from hgma_compensation.temperature import noise
from hgma_compensation.temperature.features import Product
from hgma_compensation.temperature.noise import BOUNDS, fit_trend_noise
from hgma_compensation.temperature.track import Sample, TemperatureTrack
from hgma_compensation.temperature.trend_filter import TrendNoise
from hgma_compensation.training.thermistor import FEWEST, feature_settings, usable

SEED = 20190725
TRUE = TrendNoise(process=1e-6, measurement=4e-4)
TOLERANCE_OF_SEARCH = 0.02
"""In log q and log r: the step at which the simplex may stop."""


def simulate(count, dt, seed=SEED, true=TRUE):
    random = np.random.default_rng(seed)
    covariance = true.process * np.array([[dt**3 / 3.0, dt**2 / 2.0], [dt**2 / 2.0, dt]])
    drive = random.standard_normal((count, 2)) @ np.linalg.cholesky(covariance).T
    rate = np.cumsum(drive[:, 1])
    temperature = 20.0 + np.cumsum(drive[:, 0] + dt * np.r_[0.0, rate[:-1]])
    return make_stamps(dt * np.arange(count)), temperature + np.sqrt(true.measurement) * random.standard_normal(count)


def standard_errors(count, dt):
    """Standard errors of (log q, log r) by Whittle's information of the second differences of the series."""
    angle = np.linspace(0.0, np.pi, 20001)
    process = TRUE.process * dt**3 * (2.0 + np.cos(angle)) / 3.0
    measurement = TRUE.measurement * (2.0 - 2.0 * np.cos(angle)) ** 2
    shares = np.stack([process, measurement]) / (process + measurement)
    information = 0.5 * count * np.mean(shares[:, None] * shares[None], axis=2)
    return np.sqrt(np.diag(np.linalg.inv(information)))


def logarithms(found):
    return np.log([found.process, found.measurement])


@pytest.mark.parametrize(("count", "dt"), [(4000, 1.0), (2000, 0.2), (FEWEST, 1.0)])
def test_noise_is_recovered_within_its_standard_error(count, dt):
    error = logarithms(fit_trend_noise([simulate(count, dt)])) - logarithms(TRUE)
    assert (np.abs(error) <= 4.0 * standard_errors(count, dt) + TOLERANCE_OF_SEARCH).all()


def test_measurement_noise_of_an_hour_is_known_within_a_few_percent():
    assert standard_errors(3600, 1.0)[1] < 1.2 * np.sqrt(2.0 / 3600)  # what the test above demands is not loose


def test_several_recordings_count_together():
    recordings = [simulate(4000, 1.0, seed=SEED + k) for k in range(5)]
    error = logarithms(fit_trend_noise(recordings)) - logarithms(TRUE)
    assert (np.abs(error) <= 4.0 * standard_errors(20000, 1.0) + TOLERANCE_OF_SEARCH).all()


def test_long_recording_is_judged_on_runs_spread_over_it(monkeypatch):
    monkeypatch.setattr(noise, "LONGEST_RUN", 300)
    stamps, values = simulate(6000, 1.0)
    noisy = np.arange(6000) < 3000
    values[noisy] += 5.0 * np.random.default_rng(SEED).standard_normal(3000)
    # Five runs of 300 begin at 0, 1425, 2850, 4275 and 5700; each settles over 20 samples: 690 of 1400 are noisy.
    found = fit_trend_noise([(stamps, values)]).measurement
    assert found == pytest.approx(25.0 * 690 / 1400, rel=4.0 * np.sqrt(2.0 / 690))


def test_what_a_power_off_does_to_the_temperature_does_not_enter_the_noise():
    (stamps, values), (_, others) = simulate(2000, 1.0), simulate(2000, 1.0, seed=SEED + 1)
    stamps = np.concatenate([stamps, stamps + stamps[-1] - stamps[0] + 61_000_000_000])
    alone = noise.log_likelihood((stamps[:2000], values), TRUE) + noise.log_likelihood((stamps[2000:], others), TRUE)
    together = noise.log_likelihood((stamps, np.concatenate([values, others + 40.0])), TRUE)
    assert together == pytest.approx(alone, rel=1e-9)


@pytest.mark.parametrize("count", [3, 10, 25])
@pytest.mark.parametrize("values", [lambda n: np.full(n, 20.0), lambda n: 20.0 + 0.1 * (np.arange(n) % 3)])
def test_short_and_constant_series_give_noise_within_the_bounds(count, values):
    found = fit_trend_noise([(make_stamps(np.arange(count, dtype=float)), values(count))])
    low, high = np.log(BOUNDS).T
    # The bounds hold for the logarithms, so up to the rounding of exp(log()).
    assert (low - 1e-12 <= logarithms(found)).all()
    assert (logarithms(found) <= high + 1e-12).all()


@given(
    st.lists(
        st.tuples(
            st.sampled_from([-2.0, -0.5, 0.0, 0.5, 1.0]),
            st.sampled_from([20.0, 21.0, 250.1, -100.1, np.nan, np.inf, -np.inf]),
        ),
        max_size=30,
    )
)
def test_usable_samples_are_those_that_the_track_would_take(samples):
    gaps, values = np.array(samples, dtype=float).reshape(-1, 2).T
    stamps, track = make_stamps(np.cumsum(gaps)), TemperatureTrack(TRUE)
    newest = np.maximum.accumulate(stamps) if len(stamps) else stamps
    stamps = np.maximum(stamps, newest - 5_000_000_000)  # no later than what the track calls a new beginning
    used = [track.add(int(s), float(v)) is Sample.USED for s, v in zip(stamps, values, strict=True)]
    kept = usable(Series(stamps, values))
    np.testing.assert_array_equal(kept.stamps, stamps[np.array(used, dtype=bool)])
    np.testing.assert_array_equal(kept.values, values[np.array(used, dtype=bool)])


@pytest.mark.parametrize(("rate", "latency", "horizon"), [(20.0, 0.05, 2.0), (2.0, 0.5, 5.0), (0.1, 1.0, 60.0)])
def test_latency_is_one_interval_and_horizon_ten_within_their_limits(rate, latency, horizon):
    recording = make_recording(duration_s=600.0, accel_rate=1.0, thermistor_rate=rate)
    settings = feature_settings([recording], delay=30.0, product=Product.REFERENCE, reference_temperature=20.0)
    assert settings.prediction_horizon == pytest.approx(horizon, rel=1e-12)
    assert settings.latency == pytest.approx(latency, rel=1e-12)
    assert (settings.delay, settings.product, settings.reference_temperature) == (30.0, Product.REFERENCE, 20.0)


@pytest.mark.parametrize(("count", "reason"), [(0, "thermistor"), (FEWEST - 1, f"fewer than {FEWEST} usable")])
def test_recording_with_too_few_thermistor_samples_is_refused(count, reason):
    whole = make_recording(duration_s=100.0, accel_rate=1.0)
    few = Series(whole.temperature.stamps[:count], whole.temperature.values[:count])
    with pytest.raises(RefusedError, match=f"made.*{reason}"):
        feature_settings(
            [replace(whole, temperature=few)], delay=60.0, product=Product.DELAY, reference_temperature=25.0
        )


def test_recording_with_broken_samples_is_fitted_on_the_good_ones():
    whole = make_recording(duration_s=200.0, accel_rate=1.0)
    values = whole.temperature.values.copy()
    values[::7], values[3::11] = np.nan, 1e4
    options = {"delay": 60.0, "product": Product.DELAY, "reference_temperature": 25.0}
    good = usable(Series(whole.temperature.stamps, values))
    assert len(good.stamps) == np.isfinite(values).sum() - (values == 1e4).sum()
    broken = feature_settings([replace(whole, temperature=Series(whole.temperature.stamps, values))], **options)
    assert broken == feature_settings([replace(whole, temperature=good)], **options)
