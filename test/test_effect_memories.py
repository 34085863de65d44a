"""Memories of the temperature."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from test_effects_examples import EXAMPLES, example, wild

from hgma_compensation.effects.memory import POWER_OFF, Bank, Coldness, LowPass, Play, TemperatureMemory

Array = NDArray[np.float64]
WITH_MEMORY = [name for name in EXAMPLES if example(name).memory() is not None]
celsius = st.floats(-100.0, 250.0)
step = st.floats(1e-6, 1e5)
path = st.lists(st.tuples(step, celsius), min_size=1, max_size=30)


def follow(memory: TemperatureMemory, steps: list[tuple[float, float]]) -> Array:
    """Return the states (n, m) along a path of (seconds, °C), starting in equilibrium with its first temperature."""
    state = memory.start(np.array([steps[0][1]]))
    before = steps[0][1]
    moved = np.empty((len(steps), memory.size))
    for index, (seconds, temperature) in enumerate(steps):
        state = memory.advance(state[None], np.array([[seconds]]), np.array([[before]]), np.array([[temperature]]))[0]
        before = temperature
        moved[index] = state
    return moved


@pytest.mark.parametrize("name", WITH_MEMORY)
def test_memory_moves_a_batch_as_it_moves_each_row(name: str) -> None:
    memory, at = example(name).memory(), wild()
    assert memory is not None
    random = np.random.default_rng(1)
    before = random.uniform(-10.0, 60.0, (len(at), memory.size))
    seconds, temperature = random.exponential(10.0, (len(at), 1)), at.temperature[:, None]
    came = np.roll(temperature, 1)
    every = (slice(i, i + 1) for i in range(len(at)))
    rows = [memory.advance(before[i], seconds[i], came[i], temperature[i]) for i in every]
    assert memory.advance(before, seconds, came, temperature).tobytes() == np.vstack(rows).tobytes()


@pytest.mark.parametrize("name", [name for name in WITH_MEMORY if name != "warm_up"])
def test_memory_of_the_temperature_starts_in_equilibrium(name: str) -> None:
    memory = example(name).memory()
    assert memory is not None
    start = memory.start(np.array([37.3]))
    states = follow(memory, [(1.0, 37.3), (1e4, 37.3), (1e-3, 37.3)])
    np.testing.assert_allclose(states, np.tile(start, (3, 1)), rtol=1e-14)


def test_bank_moves_as_its_memories_alone() -> None:
    memories: list[TemperatureMemory] = [LowPass((5.0, 50.0)), Play((1.0,)), LowPass((500.0,)), Play((0.1, 10.0))]
    memories += [Coldness((60.0,)), Play((2.0,), 5.0, 1.0), Coldness((600.0, 6000.0)), Play((4.0,), 5.0, 1.0)]
    at = wild(100)
    steps = list(zip([1.0] * 100, at.temperature.tolist(), strict=True))
    bank = Bank(memories)
    together = follow(bank, steps)
    for memory, places in zip(memories, bank.columns, strict=True):
        assert together[:, places].tobytes() == follow(memory, steps).tobytes()


def test_low_pass_follows_a_ramp_late_by_its_time_constant_in_the_end() -> None:
    time, rate, constants = np.arange(1.0, 2000.0, 7.0), 0.03, np.array([1.0, 60.0, 900.0])
    low_pass = LowPass(tuple(constants))
    steps = [(7.0, celsius) for celsius in (-10.0 + rate * (time - 1.0)).tolist()]
    late = rate * constants * (1.0 - np.exp(-(time[:, None] - 1.0) / constants))
    np.testing.assert_allclose(follow(low_pass, steps), -10.0 + rate * (time[:, None] - 1.0) - late, atol=1e-10)


@given(
    st.floats(1.0, 2e5),
    st.floats(1e-2, 1e5),
    celsius,
    celsius,
    celsius,
    st.lists(st.floats(0.0, 1.0), max_size=20),
)
def test_low_pass_does_not_mind_how_a_ramp_is_cut_into_steps(
    time_constant: float, seconds: float, state: float, start: float, end: float, cuts: list[float]
) -> None:
    low_pass = LowPass((time_constant,))

    def after(shares: list[float]) -> float:
        moved, last = np.array([[state]]), 0.0
        for share in shares:
            before, now = (np.array([[start + s * (end - start)]]) for s in (last, share))
            moved = low_pass.advance(moved, np.array([[(share - last) * seconds]]), before, now)
            last = share
        return float(moved[0, 0])

    assert after([*sorted(cuts), 1.0]) == pytest.approx(after([1.0]), abs=1e-9)
    late = (end - start) / seconds * time_constant
    closed = end - late + (state - start + late) * np.exp(-seconds / time_constant)
    # The closed form loses digits where the ramp is short beside the time constant.
    assert after([1.0]) == pytest.approx(closed, abs=1e-12 * (100.0 + abs(late)))


@given(path, st.floats(1.0, 2e5))
def test_low_pass_stays_within_its_input(steps: list[tuple[float, float]], time_constant: float) -> None:
    states = follow(LowPass((time_constant,)), steps)[:, 0]
    inputs = np.array([temperature for _, temperature in steps])
    slack = 1e-12 * np.abs(inputs).max()
    assert (states >= np.minimum.accumulate(inputs) - slack).all()
    assert (states <= np.maximum.accumulate(inputs) + slack).all()


@given(path, st.floats(1.0, 2e5), st.floats(0.0, 50.0))
def test_warmer_input_never_makes_the_low_pass_colder(
    steps: list[tuple[float, float]], time_constant: float, warmer: float
) -> None:
    low_pass = LowPass((time_constant,))
    above = [(seconds, temperature + warmer * (index % 2)) for index, (seconds, temperature) in enumerate(steps)]
    assert (follow(low_pass, above) >= follow(low_pass, steps) - 1e-10).all()


@given(path, st.floats(0.02, 60.0))
def test_play_stays_within_its_threshold(steps: list[tuple[float, float]], threshold: float) -> None:
    states = follow(Play((threshold,)), steps)[:, 0]
    assert (np.abs(states - [temperature for _, temperature in steps]) <= threshold * (1.0 + 1e-12) + 1e-12).all()


@given(path, st.floats(0.02, 60.0), st.lists(st.floats(0.0, 1.0), max_size=5))
def test_play_does_not_mind_the_rate(steps: list[tuple[float, float]], threshold: float, shares: list[float]) -> None:
    turns = [temperature for _, temperature in steps]
    slow = turns[:1]
    for start, end in pairwise(turns):
        between = np.clip([start + share * (end - start) for share in sorted(shares)], min(start, end), max(start, end))
        slow += [*between.tolist(), end]
    play = Play((threshold,))
    assert follow(play, [(1.0, temperature) for temperature in slow])[-1] == follow(play, steps)[-1]


@pytest.mark.parametrize("offset", [-1.0, 0.0, 0.5, 1.0])
def test_play_stands_at_first_where_its_past_has_left_it(offset: float) -> None:
    play = Play((1.0, 4.0), 20.0, offset)
    np.testing.assert_allclose(play.start(np.array([20.0])), 20.0 + offset * np.array([1.0, 4.0]))
    moved = follow(Play((1.0, 4.0), 20.0, offset), [(1.0, 20.0), (1.0, 22.5)])[-1]
    np.testing.assert_allclose(play.start(np.array([22.5])), moved)


def test_play_that_has_come_from_above_is_the_one_that_was_cooled() -> None:
    cooled = follow(Play((3.0,)), [(1.0, 60.0), (1.0, 20.0), (1.0, 22.0), (1.0, 40.0)])[1:]
    begun = follow(Play((3.0,), 60.0, 0.0), [(1.0, 20.0), (1.0, 22.0), (1.0, 40.0)])
    np.testing.assert_array_equal(begun, cooled)


def test_coldness_decays_with_power_and_grows_back_without() -> None:
    cold = Coldness((100.0, 1000.0))
    constants = np.array(cold.time_constants)
    states = follow(cold, [(50.0, 20.0), (60.0, 55.0), (300.0, 20.0), (1.0, 20.0)])
    warm = np.exp(-110.0 / constants)
    np.testing.assert_allclose(states[1], warm)
    colder = 1.0 - (1.0 - warm) * np.exp(-300.0 / constants)
    np.testing.assert_allclose(states[2], colder)
    np.testing.assert_allclose(states[3], colder * np.exp(-1.0 / constants))


def test_coldness_after_a_long_rest_is_the_exponential_since_power_on() -> None:
    seconds = np.arange(1.0, 500.0)
    states = follow(Coldness((200.0,)), [(1.0, 20.0)] * 300 + [(1e5, 20.0)] + [(1.0, 20.0)] * 499)[301:, 0]
    np.testing.assert_allclose(states[: len(seconds)], np.exp(-seconds / 200.0), rtol=1e-12)


def test_coldness_after_a_short_rest_is_less() -> None:
    rests = [follow(Coldness((200.0,)), [(50.0, 20.0)] * 40 + [(rest, 20.0)])[-1, 0] for rest in (61.0, 200.0, 2e3)]
    assert 0.2 < rests[0] < rests[1] < rests[2] < 1.0


@given(st.lists(step, min_size=1, max_size=30), st.floats(5.0, 14400.0))
def test_coldness_stays_between_warm_and_cold(steps: list[float], time_constant: float) -> None:
    states = follow(Coldness((time_constant,)), [(seconds, 20.0) for seconds in steps])
    assert ((states >= 0.0) & (states <= 1.0)).all()


def test_a_minute_between_two_stamps_is_no_pause() -> None:
    minute = round(POWER_OFF * 1e9) * 1e-9
    assert minute > POWER_OFF
    assert follow(Coldness((100.0,)), [(minute, 20.0)])[0, 0] == pytest.approx(np.exp(-0.6))
    assert follow(Coldness((100.0,)), [(minute + 1e-9, 20.0)])[0, 0] == 1.0
