import numpy as np
import pytest
from scipy.signal import lfilter

from hgma_compensation.evaluation.allan_confidence import allan_table, dense_table
from hgma_compensation.evaluation.noise_figures import Stage, bias_instability, longest_run, noise_figures
from hgma_compensation.evaluation.paper_figures_of_merit import paper_figures
from hgma_compensation.recording.csv_table import STANDARD_GRAVITY

WHITE, FLICKER = 4.76, 1.31


def white(count, interval, seed, density=WHITE):
    return density / np.sqrt(interval) * np.random.default_rng(seed).standard_normal(count)


def flicker(count, interval, seed, instability=FLICKER):
    """1/f noise by its spectrum, two-sided S(f) = B²/(2πf) (IEEE Std 952-1997, eq. C.8), half of a period."""
    random, length = np.random.default_rng(seed), 2 * count
    frequency = np.fft.rfftfreq(length, interval)
    amplitude = np.zeros(len(frequency))
    amplitude[1:] = instability * np.sqrt(length / (2.0 * np.pi * frequency[1:] * interval * 2.0))
    spectrum = amplitude * (random.standard_normal(len(frequency)) + 1j * random.standard_normal(len(frequency)))
    return np.fft.irfft(spectrum, length)[:count]


def low_pass(values, interval, seconds):
    keep = np.exp(-interval / seconds)
    return lfilter([1.0 - keep], [1.0, -keep], values)


def test_white_noise_has_the_deviation_of_theory_at_every_time():
    table = allan_table(white(200_000, 0.1, seed=1), 0.1, [0.1, 1.0, 10.0, 100.0])
    assert table.deviations == pytest.approx(WHITE / np.sqrt(table.taus), rel=0.05)
    assert table.slopes == pytest.approx(-0.5, abs=0.05)
    assert (table.lower < table.deviations).all()
    assert (table.deviations < table.upper).all()


def test_times_that_the_record_does_not_allow_are_left_out():
    table = allan_table(white(1000, 0.1, seed=1), 0.1, [0.01, 0.1, 20.0, 21.0, 1000.0])
    assert table.taus == pytest.approx([0.1, 20.0])
    assert not len(allan_table(white(1000, 0.1, seed=1), 0.1, [1e4]).taus)


@pytest.mark.parametrize(
    ("noise", "truth"),
    [
        (lambda seed: white(2000, 1.0, seed), lambda tau: WHITE / np.sqrt(tau)),
        (lambda seed: flicker(2000, 1.0, seed), lambda tau: np.full(len(tau), 0.664 * FLICKER)),
    ],
    ids=["white", "flicker"],
)
def test_the_interval_holds_the_truth_in_about_95_of_100_records(noise, truth):
    held = []
    for seed in range(200):
        table = allan_table(noise(seed), 1.0, [10.0, 40.0, 150.0])
        held.append((table.lower <= truth(table.taus)) & (truth(table.taus) <= table.upper))
    assert np.mean(held, axis=0) == pytest.approx(0.95, abs=0.04)


def test_white_noise_has_n_and_no_b():
    figures = noise_figures(white(100_000, 0.1, seed=2), 0.1)
    n = figures.velocity_random_walk
    assert n.value == pytest.approx(WHITE, rel=0.02)
    assert n.lower < WHITE < n.upper
    assert str(figures.bias_instability) == "not defined"


def test_a_flat_part_gives_b():
    values = flicker(200_000, 1.0, seed=3) + white(200_000, 1.0, seed=3, density=1.0)
    b = noise_figures(values, 1.0).bias_instability
    assert b.value == pytest.approx(FLICKER, rel=0.1)
    assert b.lower < FLICKER < b.upper


@pytest.mark.parametrize("seed", range(5))
def test_the_turn_between_white_noise_and_a_random_walk_is_no_flat_part(seed):
    walk = np.cumsum(0.05 * np.random.default_rng(100 + seed).standard_normal(100_000))
    assert bias_instability(dense_table(white(100_000, 1.0, seed) + walk, 1.0)).value is None


def test_a_filter_does_not_change_n_where_n_is_defined():
    values = low_pass(white(400_000, 0.1, seed=4), 0.1, seconds=10.0)
    figures = noise_figures(values, 0.1, Stage(10.0))
    assert figures.velocity_random_walk.tau >= 100.0
    assert figures.velocity_random_walk.value == pytest.approx(WHITE, rel=0.1)


def test_a_record_too_short_for_its_filter_has_neither_figure():
    values = low_pass(white(5000, 0.1, seed=5), 0.1, seconds=20.0)
    figures = noise_figures(values, 0.1, Stage(20.0))
    assert figures.velocity_random_walk.value is None
    assert figures.bias_instability.value is None
    assert "short" in figures.velocity_random_walk.reason


def test_the_flat_part_that_a_filter_makes_is_not_taken_for_flicker_noise():
    values = low_pass(white(200_000, 0.1, seed=6), 0.1, seconds=10.0)
    assert noise_figures(values, 0.1, Stage(10.0)).bias_instability.value is None


@pytest.mark.parametrize("seed", range(8))
def test_a_slope_of_flicker_noise_is_not_taken_for_white_noise(seed):
    values = low_pass(flicker(50_000, 1.0, seed), 1.0, seconds=100.0)
    assert noise_figures(values, 1.0, Stage(100.0)).velocity_random_walk.value is None


def test_a_stage_that_takes_a_bias_out_leaves_n_where_it_was():
    values = white(50_000, 0.1, seed=7)
    bare, unbiased = (noise_figures(values, 0.1, stage) for stage in (None, Stage(300.0, smooths=False)))
    assert unbiased.velocity_random_walk == bare.velocity_random_walk
    assert unbiased.bias_instability.value is None


def test_bandwidth_is_that_of_a_low_pass():
    assert Stage(10.0).bandwidth == pytest.approx(0.0159, abs=1e-4)
    assert Stage(10.0, smooths=False).bandwidth is None


def test_longest_run():
    assert longest_run(np.array([False, True, False, True, True])) == (3, 5)
    assert longest_run(np.array([False])) == (0, 0)
    assert longest_run(np.empty(0, dtype=bool)) == (0, 0)


def test_the_papers_reading_gives_its_raw_figures():
    readings = []
    for seed in range(40):
        values = white(36_000, 0.1, seed) + flicker(36_000, 0.1, 1000 + seed)
        figures = paper_figures(values * STANDARD_GRAVITY, 0.1)
        readings.append((figures.acceleration_random_walking, figures.bias_stability))
    assert np.mean(readings, axis=0) == pytest.approx([17130.0, 4720.0], rel=0.06)


def test_the_papers_reading_needs_a_deviation_at_one_second():
    with pytest.raises(ValueError, match="at 1 s"):
        paper_figures(white(1000, 2.0, seed=1), 2.0)
