"""What is wrong with the outputs of a node that compensated the samples of ``imu_source``."""

from array import array
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Request:
    """A request to load a file: ns at which it was sent and answered, and the calibration in use after it."""

    sent: int
    answered: int
    in_use: int


def _numbers() -> "array[float]":
    return array("d")


def _integers() -> "array[int]":
    return array("q")


@dataclass
class Recorded:
    """Outputs in the order in which they came: compensated samples first, then their states.

    x: m/s². number: of the sample. stamp, published, state_stamp: ns. calibration: number of that in the state.
    drift: m/s², as the state says.
    """

    x: "array[float]" = field(default_factory=_numbers)
    number: "array[float]" = field(default_factory=_numbers)
    stamp: "array[int]" = field(default_factory=_integers)
    published: "array[int]" = field(default_factory=_integers)
    drift: "array[float]" = field(default_factory=_numbers)
    calibration: "array[int]" = field(default_factory=_integers)
    state_stamp: "array[int]" = field(default_factory=_integers)


def faults_of(recorded: Recorded, sent: int, offsets: Sequence[float], requests: Sequence[Request]) -> dict[str, int]:
    """Return how many outputs are at fault, by the kind of fault.

    sent: number of samples. offsets: what each calibration subtracts; the first one is in use at the start.
    """
    count = min(len(recorded.x), len(recorded.calibration))
    number, calibration = np.array(recorded.number)[:count], np.array(recorded.calibration)[:count]
    published, offset = np.array(recorded.published)[:count], np.array(offsets)[calibration]
    wrong = (np.array(recorded.x)[:count] != number - offset) | (np.array(recorded.drift)[:count] != offset)
    other = np.array(recorded.stamp)[:count] != np.array(recorded.state_stamp)[:count]
    changes = int(np.count_nonzero(np.diff(calibration)))
    wanted = int(np.count_nonzero(np.diff([0, *(request.in_use for request in requests)])))
    different = len(np.unique(np.array(recorded.number)))
    return {
        "lost": sent - different,
        "twice": len(recorded.x) - different,
        "out_of_order": int(np.count_nonzero(np.diff(number) <= 0.0)),
        "without_state": len(recorded.x) - len(recorded.calibration),
        "other_state": int(np.count_nonzero(other)),
        "mixed": int(np.count_nonzero(wrong)),
        "at_the_wrong_time": int(np.count_nonzero(~_allowed(calibration, published, requests))),
        "changed_back": max(changes - wanted, 0),
    }


def _allowed(
    calibration: NDArray[np.int64], published: NDArray[np.int64], requests: Sequence[Request]
) -> NDArray[np.bool_]:
    """Return whether each output (n,) may belong to its calibration, by the time (ns) at which it was published.

    Between two requests that is the one in use; while one is answered, that before it or that after it.
    """
    sent, answered, in_use = (
        np.array([0, *(getattr(request, name) for request in requests)]) for name in ("sent", "answered", "in_use")
    )
    last = np.searchsorted(sent, published, side="right") - 1
    before = in_use[np.maximum(last - 1, 0)]
    return np.asarray((calibration == in_use[last]) | ((published <= answered[last]) & (calibration == before)))
