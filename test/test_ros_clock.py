import pytest
from hypothesis import given
from hypothesis import strategies as st

from hgma_compensation.node.ros_clock import SILENCE, ClockWatch

pytestmark = pytest.mark.ros


class Wall:
    """A clock that the test turns."""

    def __init__(self):
        self.now = 100.0

    def __call__(self):
        return self.now


def test_a_clock_that_moves_is_never_called_silent():
    wall = Wall()
    watch = ClockWatch(wall)
    for second in range(100):
        wall.now += 1.0
        assert not watch.look(second * 10)
    assert not watch.silent


def test_silence_is_said_once_and_so_is_its_end():
    wall = Wall()
    watch = ClockWatch(wall)
    said = []
    for second, time in enumerate([0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 2, 2, 2, 2, 2, 2, 2, 2]):
        wall.now = 100.0 + second
        if watch.look(time):
            said.append((second, watch.silent))
    assert said == [(6, True), (9, False), (16, True)]


def test_another_clock_is_watched_anew():
    wall = Wall()
    watch = ClockWatch(wall)
    watch.look(0)
    wall.now += 2.0 * SILENCE
    watch.forget()
    assert not watch.look(0)
    assert not watch.silent


@given(st.lists(st.tuples(st.floats(0.1, 20.0), st.booleans()), max_size=50))
def test_it_is_silent_exactly_where_the_last_step_is_too_long_ago(looks):
    wall = Wall()
    watch = ClockWatch(wall)
    watch.look(0)
    time, moved_at = 0, wall.now
    for step, moves in looks:
        wall.now += step
        if moves:
            time, moved_at = time + 1, wall.now
        before = watch.silent
        assert watch.look(time) is (before is not watch.silent)
        assert watch.silent is (wall.now - moved_at > SILENCE)
