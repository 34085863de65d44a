"""The soak's own eyes: each kind of fault is seen."""

from array import array

import pytest

from benchmarks.soak.reload_account import Recorded, Request, faults_of

OFFSETS = [1.0, 2.0]
REQUESTS = [Request(sent=35, answered=55, in_use=1), Request(sent=65, answered=75, in_use=1)]


def recorded(used=(0, 0, 0, 0, 1, 1, 1, 1, 1, 1), **changes):
    """Return ten outputs published every 10 ns, swapped to the second calibration while the first request runs."""
    numbers = list(range(10))
    fields = {
        "number": numbers,
        "x": [number - OFFSETS[which] for number, which in zip(numbers, used, strict=True)],
        "drift": [OFFSETS[which] for which in used],
        "stamp": [10 * number - 1 for number in numbers],
        "published": [10 * number for number in numbers],
        "state_stamp": [10 * number - 1 for number in numbers],
        "calibration": list(used),
    }
    arrays = {name: array("d" if name in ("number", "x", "drift") else "q", fields[name]) for name in fields}
    for name, change in changes.items():
        change(arrays[name])
    return Recorded(**arrays)


def put(index, value):
    return lambda values: values.__setitem__(index, value)


@pytest.mark.parametrize("swapped_at", [4, 5, 6])
def test_a_swap_while_it_is_asked_for_is_no_fault(swapped_at):
    outputs = recorded([0] * swapped_at + [1] * (10 - swapped_at))
    assert not any(faults_of(outputs, 10, OFFSETS, REQUESTS).values())


@pytest.mark.parametrize(
    ("outputs", "sent", "fault"),
    [
        (recorded(), 11, "lost"),
        (recorded(number=put(3, 2.0)), 10, "twice"),
        (recorded(number=put(9, 0.5)), 10, "out_of_order"),
        (recorded(state_stamp=put(4, 7)), 10, "other_state"),
        (recorded(x=put(7, 7.0 - 1.0)), 10, "mixed"),
        (recorded(drift=put(7, 1.0)), 10, "mixed"),
        (recorded([0, 0, 0, 1, 1, 1, 1, 1, 1, 1]), 10, "at_the_wrong_time"),
        (recorded([0, 0, 0, 0, 0, 0, 0, 1, 1, 1]), 10, "at_the_wrong_time"),
        (recorded([0, 0, 0, 0, 1, 0, 1, 1, 1, 1]), 10, "changed_back"),
    ],
)
def test_each_kind_of_fault_is_counted(outputs, sent, fault):
    assert faults_of(outputs, sent, OFFSETS, REQUESTS)[fault] >= 1


def test_an_output_without_its_state_is_counted():
    cut = {name: lambda values: values.pop() for name in ("drift", "calibration", "state_stamp")}
    assert faults_of(recorded(**cut), 10, OFFSETS, REQUESTS)["without_state"] == 1
