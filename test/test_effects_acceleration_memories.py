"""Memories of the acceleration."""

from itertools import pairwise

import numpy as np
import pytest
import sequential_memories
from hypothesis import given, settings
from hypothesis import strategies as st
from kalman_streams import CLOCKS, clock
from numpy.typing import NDArray
from test_effects_examples import EXAMPLES, example, stamps_at, wild

from hgma_compensation.effects.acceleration_memory import ShockSums, VibrationLevel
from hgma_compensation.effects.memory import AccelerationMemory
from hgma_compensation.stamps import NANOSECONDS, Stamps

Array = NDArray[np.float64]
WITH_MEMORY = [name for name in EXAMPLES if example(name).acceleration_memory() is not None]


def run(memory: AccelerationMemory, stamps: Stamps, acceleration: Array, *cuts: int) -> Array:
    """Return the states (n, m) after each sample, the samples given in parts."""
    state, parts = memory.start(), []
    for start, end in pairwise((0, *sorted(cuts), len(stamps))):
        states = memory.run(state, stamps[start:end], acceleration[start:end])
        state = states[-1] if len(states) else state
        parts.append(states)
    return np.vstack(parts)


@pytest.mark.parametrize("name", WITH_MEMORY)
@given(st.lists(st.integers(0, 120), max_size=6), st.integers(0, 1000))
def test_acceleration_may_come_in_any_parts(name: str, cuts: list[int], seed: int) -> None:
    memory, at = example(name).acceleration_memory(), wild(120, seed)
    assert memory is not None
    acceleration = at.acceleration[:, 1]
    acceleration[5] = np.nan
    whole = run(memory, at.stamps, acceleration)
    assert whole.shape == (120, memory.size)
    assert run(memory, at.stamps, acceleration, *cuts).tobytes() == whole.tobytes()
    assert run(memory, at.stamps, acceleration, *range(120)).tobytes() == whole.tobytes()


MEMORIES = {
    "vibration": (VibrationLevel(0.3, 1.0), sequential_memories.VibrationLevel(0.3, 1.0)),
    "shocks": (ShockSums(50.0, 0.2), sequential_memories.ShockSums(50.0, 0.2)),
}


@st.composite
def streams(draw: st.DrawFn) -> tuple[Stamps, Array]:
    """Return up to 3000 samples with shocks one after the other or alone, new levels, and some that are not finite."""
    random = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    count = draw(st.integers(1, 3000))
    stamps = clock(draw(st.sampled_from(CLOCKS)), count, random)
    if draw(st.booleans()):
        stamps = stamps[0] + 30 * (stamps - stamps[0])  # shocks then end, and what lasts is a new level
    if draw(st.booleans()):
        stamps[random.integers(0, count) :] += 12 * NANOSECONDS
    acceleration = 9.81 + random.standard_normal(count)
    acceleration[random.integers(0, count, draw(st.sampled_from([0, 1, 40])))] += 1000.0 * random.standard_normal()
    acceleration[random.integers(0, count) :] += draw(st.sampled_from([0.0, 200.0]))
    acceleration[random.integers(0, count, 3)] = draw(st.sampled_from([9.0, np.nan, np.inf, -np.inf, 1e100]))
    return stamps, acceleration


@pytest.mark.parametrize("kind", MEMORIES)
@settings(deadline=None, max_examples=60)
@given(streams(), st.lists(st.integers(0, 3000), max_size=4))
def test_many_samples_at_once_are_the_same_as_one_by_one(
    kind: str, stream: tuple[Stamps, Array], cuts: list[int]
) -> None:
    (memory, stepwise), (stamps, acceleration) = MEMORIES[kind], stream
    whole = run(memory, stamps, acceleration)
    assert run(memory, stamps, acceleration, *(cut for cut in cuts if cut < len(stamps))).tobytes() == whole.tobytes()
    assert run(memory, stamps, acceleration, *range(len(stamps))).tobytes() == whole.tobytes()
    np.testing.assert_allclose(whole, run(stepwise, stamps, acceleration), rtol=1e-9, atol=1e-9)


def test_vibration_level_is_the_variance_of_what_is_fast() -> None:
    seconds = np.arange(0.0, 200.0, 0.01)
    noise = np.random.default_rng(4).normal(0.0, 3.0, len(seconds))
    level = run(VibrationLevel(20.0), stamps_at(seconds), noise + 0.5 * seconds)[-1, 0]
    assert level == pytest.approx(9.0, rel=0.1)


def test_vibration_level_stays_about_0_at_rest_where_the_floor_is_the_noise() -> None:
    seconds = np.arange(0.0, 300.0, 0.01)
    noise = np.random.default_rng(4).normal(0.0, 3.0, len(seconds))
    level = run(VibrationLevel(10.0, 9.0), stamps_at(seconds), noise)[:, 0]
    # Half the squared difference has a variance of 3 σ⁴ with its neighbours' correlation; a low-pass over 1000 samples
    # leaves √(3/2000) of it.
    assert np.abs(level).max() < 5.0 * 9.0 * np.sqrt(3.0 / 2000.0)
    assert abs(level.mean()) < 0.1 * 9.0
    assert run(VibrationLevel(10.0), stamps_at(seconds), noise)[-1, 0] == pytest.approx(9.0 + level[-1], abs=1e-6)


def test_vibration_level_rises_with_its_time_constant() -> None:
    seconds = np.arange(0.0, 10.001, 0.01)
    alternating = np.where(np.arange(len(seconds)) % 2, 2.0, -2.0)
    level = run(VibrationLevel(10.0), stamps_at(seconds), alternating)[-1, 0]
    assert level == pytest.approx(8.0 * (1.0 - np.exp(-1.0)), rel=1e-9)


def test_vibration_level_is_held_over_gaps_and_lost_samples() -> None:
    seconds = np.array([0.0, 1.0, 12.0, 13.0, 14.0, 12.5])
    acceleration = np.array([0.0, 2.0, 100.0, np.inf, -100.0, 7.0])
    level = run(VibrationLevel(10.0), stamps_at(seconds), acceleration)[:, 0]
    assert level[1] > 0.0
    np.testing.assert_array_equal(level[1:], level[1])


def shocks(*events: tuple[float, float], duration: float = 60.0) -> tuple[Stamps, Array]:
    """Return samples at 100 Hz of 9.81 m/s² with single ones (s, m/s²) added."""
    acceleration = np.full(round(duration * 100.0), 9.81)
    for second, height in events:
        acceleration[round(second * 100.0)] += height
    return stamps_at(np.arange(len(acceleration)) / 100.0), acceleration


SUMS = ShockSums(threshold=50.0, time_constant=20.0)


def test_two_identical_shocks_add_up() -> None:
    states = run(SUMS, *shocks((10.0, 1000.0), (30.0, 1000.0)))
    np.testing.assert_allclose(states[[999, 1000, 2999, 3000, -1], 0], [0.0, 1e3, 1e3, 2e3, 2e3])
    left = np.exp(-1.0)
    np.testing.assert_allclose(states[[1000, 3000, 5000], 1], [1e3, 1e3 + 1e3 * left, (1e3 + 1e3 * left) * left])


def test_ringing_is_one_shock_with_its_largest_peak() -> None:
    states = run(SUMS, *shocks((10.0, 600.0), (10.3, -1000.0), (10.9, 900.0), (11.5, 70.0), (12.6, -300.0)))
    np.testing.assert_allclose(states[[1000, 1030, 1200, 1300], 0], [600.0, -1000.0, -1000.0, -1300.0])
    assert states[1030, 1] == pytest.approx(-1000.0)
    assert states[1259, 1] == pytest.approx(-1000.0 * np.exp(-2.29 / 20.0))


def test_opposite_shocks_cancel_for_good() -> None:
    states = run(SUMS, *shocks((10.0, 1000.0), (30.0, -1000.0)))
    assert states[-1, 0] == pytest.approx(0.0, abs=1e-9)
    assert states[-1, 1] < -100.0


def test_slow_drift_is_no_shock() -> None:
    stamps, acceleration = shocks()
    states = run(SUMS, stamps, acceleration + np.linspace(0.0, 1000.0, len(stamps)))
    assert not states[:, :2].any()


def test_a_level_that_moved_is_no_shock_but_later_ones_are() -> None:
    stamps, acceleration = shocks((40.0, 1000.0))
    acceleration[2000:] += 200.0
    states = run(SUMS, stamps, acceleration)
    np.testing.assert_allclose(states[[2000, 2500, -1], 0], [200.0, 0.0, 1000.0], atol=1e-9)


def test_a_shock_that_moves_the_level_stays_one() -> None:
    stamps, acceleration = shocks((20.0, 5000.0), (40.0, 1000.0))
    acceleration[2000:] += 200.0
    states = run(SUMS, stamps, acceleration)
    np.testing.assert_allclose(states[[2000, 2500, -1], 0], [5200.0, 5200.0, 6200.0])


def test_a_new_level_after_a_gap_is_no_shock() -> None:
    stamps, acceleration = shocks((50.0, 1000.0))
    acceleration[3000:] += 400.0
    stamps[3000:] += 11 * NANOSECONDS
    states = run(SUMS, stamps, acceleration)
    np.testing.assert_allclose(states[[3000, 3001, -1], 0], [0.0, 0.0, 1000.0])
