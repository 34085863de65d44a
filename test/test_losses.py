import random
from collections import Counter

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hgma_compensation.node.losses import CountedInput, SequenceGaps
from hgma_compensation.pipeline.reasons import REMEDIES

pytestmark = pytest.mark.ros


def lost(numbers, publishers=1):
    gaps = SequenceGaps()
    return sum(gaps.add(number, lambda: publishers) for number in numbers)


class Waiting:
    """A subscription that holds messages of these numbers."""

    msg_type, raw = None, True

    def __init__(self, numbers):
        self._numbers = list(numbers)
        self.handle = self

    def __enter__(self):
        return self

    def __exit__(self, *_):
        pass

    def take_message(self, *_):
        return (b"message", {"publication_sequence_number": self._numbers.pop(0)}) if self._numbers else None

    def get_publisher_count(self):
        return 1


@given(st.sets(st.integers(1, 300), min_size=1))
def test_what_is_missing_between_the_first_and_the_last_number_is_lost(numbers):
    assert lost(sorted(numbers)) == max(numbers) - min(numbers) + 1 - len(numbers)


@given(st.integers(1, 1000), st.integers(1, 50))
def test_a_publisher_that_begins_anew_has_lost_nothing(last, count):
    assert lost([*range(last, last + 10), *range(1, count)]) == 0


@given(st.lists(st.booleans(), min_size=1, max_size=200), st.integers(1, 400))
def test_publishers_that_take_turns_are_told_apart(turns, ahead):
    following = [iter(range(1, 1000)), iter(range(1 + ahead, 2000))]
    assert lost([next(following[turn]) for turn in turns], publishers=2) == 0


def test_losses_of_each_of_two_publishers_are_counted():
    numbers = [1, 1001, 2, 1002, 5, 1003, 6, 1010]
    assert lost(numbers, publishers=2) == 2 + 6


def test_a_publisher_that_replaces_another_with_higher_numbers_costs_nothing_while_both_are_known():
    gaps = SequenceGaps()
    assert [gaps.add(number, lambda: 2) for number in (10, 11, 900, 901)] == [0, 0, 0, 0]
    assert [gaps.add(number, lambda: 1) for number in (902, 905)] == [0, 2]


def test_the_numbers_are_asked_for_only_where_one_is_not_the_next():
    asked = []
    gaps = SequenceGaps()
    for number in (7, *range(8, 100), 200):
        gaps.add(number, lambda: asked.append(1) or 1)
    assert len(asked) == 2  # the first number and the gap


def test_a_middleware_without_numbers_counts_nothing():
    counts = Counter()
    counted = CountedInput("accel/raw", counts, Waiting([None] * 3))
    assert counted.take(10) == [b"message"] * 3
    assert not counts


def test_messages_are_taken_in_order_up_to_a_number_and_the_gaps_between_them_are_counted():
    counts = Counter()
    counted = CountedInput("accel/raw", counts, Waiting([1, 2, 5, 9]))
    assert [len(counted.take(most)) for most in (3, 3, 3)] == [3, 1, 0]
    assert counts == {"raw_lost_in_transport": 2 + 3}


@given(st.randoms(use_true_random=False))
def test_a_shuffled_stream_never_counts_less_than_nothing(generator: random.Random):
    numbers = list(range(50))
    generator.shuffle(numbers)
    gaps = SequenceGaps()
    assert all(gaps.add(number, lambda: 1) >= 0 for number in numbers)


def test_each_name_that_is_counted_tells_what_to_do():
    assert {"raw_lost_in_transport", "temperature_2_lost_in_transport", "compensated_qos_incompatible"} <= set(REMEDIES)
