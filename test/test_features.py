from math import sqrt

import numpy as np
import pytest
from builders import EPOCH, make_stamps
from hypothesis import given
from hypothesis import strategies as st

from hgma_compensation.stamps import NANOSECONDS, to_nanoseconds
from hgma_compensation.temperature.features import Features, FeatureSettings, Product, read_features
from hgma_compensation.temperature.track import TemperatureTrack
from hgma_compensation.temperature.trend_filter import TrendNoise

NOISE = TrendNoise(process=1e-5, measurement=1e-4)
LEAD = 30.0
"""s by which thermistor messages may arrive before the accelerations that they precede."""


def join(parts):
    return Features(*(np.concatenate([getattr(p, name) for p in parts]) for name in Features.__dataclass_fields__))


def bits(features):
    return b"".join(getattr(features, name).tobytes() for name in Features.__dataclass_fields__)


@st.composite
def two_topics(draw):
    """Thermistor with repeated, late, missing and broken samples; acceleration stamps that begin before it."""
    random = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    thermistors, accelerations = draw(st.integers(1, 700)), draw(st.integers(1, 60))
    gaps = random.choice(
        [-0.3, 0.0, 0.1, 0.5, 1.0, 15.0, 90.0], thermistors, p=[0.03, 0.03, 0.43, 0.3, 0.19, 0.01, 0.01]
    )
    celsius = 20.0 + np.cumsum(0.05 * random.standard_normal(thermistors))
    celsius[random.random(thermistors) < 0.02] = random.choice([np.nan, 1e6])
    celsius[random.random(thermistors) < 0.02] += 30.0
    stamps = make_stamps(np.cumsum(gaps))
    span = float(np.sum(gaps))
    times = np.sort(random.uniform(-5.0, max(span, 0.0) + 40.0, accelerations))
    on_edge = random.choice([0, *range(thermistors)], accelerations)  # exactly where a sample becomes usable
    use_edge = random.random(accelerations) < 0.3
    settings = FeatureSettings(
        NOISE, draw(st.sampled_from(Product)), delay=draw(st.floats(0.1, 60.0)), latency=draw(st.floats(0.0, 2.0))
    )
    latency = to_nanoseconds(settings.latency) * random.integers(0, 2, accelerations)
    edges = stamps[on_edge] + latency - random.integers(0, 2, accelerations)
    at = np.sort(np.where(use_edge, edges, make_stamps(times)))
    return random, settings, stamps, celsius, at


def power_ons(stamps, celsius):
    """Return the rows of the first sample and of those after more than a minute of silence."""
    rows, last = [], None
    for row in np.flatnonzero(np.isfinite(celsius) & (celsius < 100.0)).tolist():
        if last is None or stamps[row] > last + 60 * NANOSECONDS:
            rows.append(row)
        last = stamps[row] if last is None else max(last, stamps[row])
    return rows


@pytest.mark.parametrize("live", [False, True])
@given(topics=two_topics())
def test_any_causal_interleaving_equals_the_batch_bit_for_bit(live, topics):
    random, settings, stamps, celsius, at = topics
    batch = TemperatureTrack(NOISE)
    batch.extend(stamps, celsius)
    stream = TemperatureTrack(NOISE, keep=settings.history + LEAD if live else None)
    given_so_far, parts = 0, []
    starts = power_ons(stamps, celsius)
    latency = to_nanoseconds(settings.latency)
    for stamp in at:
        usable = stamps <= stamp - latency
        usable[starts] = stamps[starts] <= stamp  # the first one after a power-on counts from its own stamp on
        needed = np.flatnonzero(usable).max(initial=-1) + 1
        allowed = np.flatnonzero(stamps <= stamp + to_nanoseconds(LEAD)).max(initial=-1) + 1
        until = max(given_so_far, needed, int(random.integers(0, allowed + 1)))
        stream.extend(stamps[given_so_far:until], celsius[given_so_far:until])
        given_so_far = until
        parts.append(read_features(stream, settings, np.array([stamp])))
    assert bits(join(parts)) == bits(read_features(batch, settings, at))


@given(topics=two_topics(), cuts=st.lists(st.integers(0, 60), max_size=8))
def test_any_split_of_the_stamps_equals_the_batch_bit_for_bit(topics, cuts):
    _, settings, stamps, celsius, at = topics
    track = TemperatureTrack(NOISE)
    track.extend(stamps, celsius)
    parts = [read_features(track, settings, part) for part in np.split(at, sorted(min(cut, len(at)) for cut in cuts))]
    assert bits(join(parts)) == bits(read_features(track, settings, at))


def ramp(rate, seconds):
    times = np.arange(0.0, seconds, 0.5)
    track = TemperatureTrack(NOISE)
    track.extend(make_stamps(times), -10.0 + rate * times)
    return track


def test_product_on_a_ramp_is_temperature_times_rate_times_delay():
    rate, settings = 0.05, FeatureSettings(NOISE, delay=60.0)
    # 30 time constants of the trend filter, √2 (r dt / q)^(1/4), leave e^-30 of its start; then the delay.
    settled = 30.0 * sqrt(2.0) * (NOISE.measurement * 0.5 / NOISE.process) ** 0.25 + settings.delay + 1.0
    times = np.arange(settled, 500.0, 0.17)
    features = read_features(ramp(rate, 500.0), settings, make_stamps(times))
    temperature = -10.0 + rate * times
    expected = np.column_stack([temperature, np.full(len(times), rate), temperature * rate * settings.delay])
    np.testing.assert_allclose(features.values, expected, rtol=0.0, atol=1e-9)


def test_delayed_temperature_is_what_was_read_that_long_ago():
    settings, random = FeatureSettings(NOISE, delay=20.0, latency=1.0), np.random.default_rng(20190725)
    track = TemperatureTrack(NOISE)
    track.extend(make_stamps(np.arange(0.0, 100.0, 0.7)), 20.0 + random.standard_normal(143))
    at = make_stamps(np.arange(30.0, 100.0, 0.13))
    now = read_features(track, settings, at).values
    earlier = read_features(track, settings, at - 20 * NANOSECONDS).values
    np.testing.assert_array_equal(now[:, 2], now[:, 0] * (now[:, 0] - earlier[:, 0]))


def test_product_with_reference_is_the_papers():
    settings = FeatureSettings(NOISE, Product.REFERENCE, reference_temperature=25.0)
    values = read_features(ramp(0.05, 500.0), settings, make_stamps(np.arange(1.0, 500.0, 0.7))).values
    temperature, product = values[:, 0], values[:, 2]
    rounding = 4.0 * np.finfo(float).eps * (temperature**2).max()
    np.testing.assert_allclose(product, temperature**2 - 25.0 * temperature, rtol=0.0, atol=rounding)


def test_no_features_before_the_first_sample_and_known_ages_after_it():
    settings = FeatureSettings(NOISE, latency=0.25)
    track = TemperatureTrack(NOISE)
    at = EPOCH + np.array([-NANOSECONDS, -1, 0, 2 * NANOSECONDS])
    nothing = read_features(track, settings, at)
    assert np.isnan(nothing.values).all()
    assert (nothing.age == np.inf).all()
    assert (nothing.since_power_on == -np.inf).all()
    track.extend([EPOCH, EPOCH + NANOSECONDS], [20.0, 21.0])
    features = read_features(track, settings, at)
    np.testing.assert_array_equal(np.isnan(features.values).all(axis=1), [True, True, False, False])
    np.testing.assert_array_equal(features.age, [np.inf, np.inf, 0.0, 1.0])
    np.testing.assert_array_equal(features.since_power_on, [-np.inf, -np.inf, 0.0, 2.0])
    assert features.values[2].tolist() == [20.0, 0.0, 0.0]


def test_delay_longer_than_the_history_assumes_equilibrium_before_it():
    settings = FeatureSettings(NOISE, delay=60.0)
    track = ramp(0.05, 20.0)
    temperature, _, product = read_features(track, settings, make_stamps(np.array([19.0]))).values[0]
    assert product == temperature * (temperature - track.first_temperature)


def gapped(random, gap=200.0):
    """Return a track of two noisy ramps with a gap between them, one of the second alone, and where that begins."""
    first, second = np.cumsum(random.uniform(0.1, 0.9, 300)), np.cumsum(random.uniform(0.1, 0.9, 300))
    second += first[-1] + gap - second[0]
    celsius = np.concatenate([20.0 + 0.1 * first, 55.0 - 0.02 * second]) + 0.01 * random.standard_normal(600)
    whole, alone = TemperatureTrack(NOISE), TemperatureTrack(NOISE)
    whole.extend(make_stamps(np.concatenate([first, second])), celsius)
    alone.extend(make_stamps(second), celsius[300:])
    return whole, alone, float(second[0])


@pytest.mark.parametrize("product", list(Product))
@given(seed=st.integers(0, 2**32 - 1), latency=st.floats(0.0, 2.0), delay=st.floats(0.1, 300.0))
def test_after_a_power_on_features_are_those_of_a_recording_that_starts_there(product, seed, latency, delay):
    random = np.random.default_rng(seed)
    whole, alone, start = gapped(random)
    settings = FeatureSettings(NOISE, product, delay=delay, latency=latency)
    at = make_stamps(start + np.concatenate([[0.0], np.sort(random.uniform(0.0, 200.0, 60))]))
    assert bits(read_features(whole, settings, at)) == bits(read_features(alone, settings, at))


def test_at_a_power_on_the_temperature_is_taken_to_have_been_steady():
    whole, _, start = gapped(np.random.default_rng(5))
    features = read_features(whole, FeatureSettings(NOISE, latency=1.0), make_stamps(np.array([start, start + 30.0])))
    assert features.values[0, 1:].tolist() == [0.0, 0.0]
    assert features.since_power_on == pytest.approx([0.0, 30.0])
    temperature, _, product = features.values[1]
    at_power_on = features.values[0, 0]
    assert product == pytest.approx(temperature * (temperature - at_power_on), rel=1e-12)


def test_during_a_gap_the_temperature_before_it_is_held_and_grows_old():
    whole, _, start = gapped(np.random.default_rng(5))
    settings = FeatureSettings(NOISE, prediction_horizon=10.0)
    held = read_features(whole, settings, make_stamps(start - np.array([150.0, 60.0, 1e-6])))
    np.testing.assert_array_equal(held.values[:, 0], held.values[0, 0])
    assert (held.age > 49.0).all()
    assert (held.since_power_on > 100.0).all()
