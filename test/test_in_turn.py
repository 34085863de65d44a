"""Work that a thread does in the order in which it is given."""

import threading
from contextlib import closing

import pytest

from hgma_compensation.recording.in_turn import InTurn


def test_calls_are_made_in_their_order_by_another_thread():
    done = []
    with closing(InTurn(2)) as turn:
        for number in range(50):
            turn.submit(lambda number=number: done.append((number, threading.current_thread())))
        turn.wait()
    assert [number for number, _ in done] == list(range(50))
    assert {thread for _, thread in done} != {threading.current_thread()}


def test_no_more_calls_wait_than_are_allowed():
    release, started = threading.Event(), []
    with closing(InTurn(2)) as turn:
        for number in range(3):
            turn.submit(lambda number=number: (started.append(number), release.wait(5.0)))
        timer = threading.Timer(0.05, release.set)
        timer.start()
        turn.submit(lambda: None)
        assert release.is_set()


def test_what_a_call_raises_is_raised_later_and_what_waits_is_given_up():
    release, done = threading.Event(), []

    def fail():
        release.wait(5.0)
        raise ValueError("no")

    def give_three():
        with closing(InTurn(1)) as turn:
            turn.submit(fail)
            turn.submit(done.append, 1)
            release.set()
            turn.submit(done.append, 2)

    with pytest.raises(ValueError, match="no"):
        give_three()
    assert 2 not in done


def test_what_waits_is_given_up_when_the_thread_is_ended():
    release, done = threading.Event(), []
    turn = InTurn(4)
    turn.submit(release.wait, 0.2)
    turn.submit(done.append, 1)
    turn.close()
    assert done == []
