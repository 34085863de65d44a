import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from hgma_compensation.diagnosis.smoothing import Smoothed
from hgma_compensation.diagnosis.stepping import Path, walk
from hgma_compensation.effects.memory import Bank, Coldness, LowPass, Play
from hgma_compensation.stamps import NANOSECONDS

LIMITS = (-5.0, 45.0)
MEMORIES = (LowPass((3.0, 700.0)), Play((0.5, 8.0)), LowPass((40.0,)), Coldness((30.0, 900.0)), Play((2.0,), 10.0, 0.5))


def run_of(random, count):
    """A run of samples 0.5 to 2 s apart, one pause without power among them, partly outside of the limits."""
    steps = random.uniform(0.5, 2.0, count)
    steps[count // 2] = 400.0
    stamps = (10**18 + np.cumsum(steps) * NANOSECONDS).astype(np.int64)
    temperature = 20.0 + np.cumsum(random.normal(0.0, 2.0, count))
    return Smoothed(stamps, temperature, np.zeros(count), np.zeros(count))


def path_of(random, count, wanted):
    run = run_of(random, count)
    at = np.sort(random.integers(run.stamps[0], run.stamps[-1] + 3 * NANOSECONDS, wanted))
    return Path.along(run, LIMITS, at)


def starts(bank, paths):
    return np.stack([bank.start(path.temperature[:1]) for path in paths])


def one_sample_after_the_other(bank, path):
    """States at the wanted stamps, and at the end."""
    state, states = bank.start(path.temperature[:1])[None], []
    for k, temperature in enumerate(path.temperature):
        if k:
            seconds = np.array([[(path.stamps[k] - path.stamps[k - 1]) * 1e-9]])
            state = bank.advance(state, seconds, path.temperature[k - 1 : k, None], np.array([[temperature]]))
        states.append(state[0])
    kept = []
    for row, index in enumerate(path.index):
        age = np.array([[max((path.wanted[row] - path.stamps[index]) * 1e-9, 0.0)]])
        before, after = path.temperature[index].reshape(1, 1), path.there[row].reshape(1, 1)
        kept.append(bank.advance(states[index][None], age, before, after)[0])
    return np.array(kept).reshape(-1, bank.size), state[0]


@given(
    seed=st.integers(0, 2**32 - 1),
    counts=st.lists(st.integers(2, 40), min_size=1, max_size=5),
    chosen=st.sets(st.sampled_from(range(len(MEMORIES))), min_size=1),
)
def test_runs_side_by_side_give_the_bits_of_each_alone_and_of_one_sample_after_the_other(seed, counts, chosen):
    random = np.random.default_rng(seed)
    bank = Bank([MEMORIES[i] for i in sorted(chosen)])
    paths = [path_of(random, count, int(random.integers(0, 12))) for count in counts]
    together, _ = walk(bank, paths, starts(bank, paths))
    for path, states in zip(paths, together, strict=True):
        alone, end = walk(bank, [path], starts(bank, [path]))
        assert states.tobytes() == alone[0].tobytes()
        expected, last = one_sample_after_the_other(bank, path)
        assert states.tobytes() == expected.tobytes()
        assert end[0].tobytes() == last.tobytes()


def test_temperatures_are_kept_inside_the_limits():
    run = run_of(np.random.default_rng(1), 200)
    path = Path.along(run, LIMITS, run.stamps)
    assert run.temperature.min() < LIMITS[0] < path.temperature.min() + 1e-9
    assert path.there.max() <= LIMITS[1]
