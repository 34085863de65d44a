"""The messages of the message rows: Imu with a number in a field that nothing touches, and what came back of them."""

from dataclasses import dataclass
from math import sqrt

import numpy as np
from numpy.typing import NDArray

from benchmarks.bench.samples import DENSITY, SEED, STILL
from benchmarks.soak.serialised import NUMBER, STAMP, STAMP_AT, acceleration_at, imu_template, orientation_at
from hgma_compensation.stamps import NANOSECONDS

POOL = 4096
"""Accelerations, one after the other and again."""


class ImuStream:
    """Serialised messages, numbered from 0 and evenly stamped from a moment on."""

    def __init__(self, rate: float, start: int) -> None:
        """Take the rate in Hz, which the noise goes by, and the stamp of number 0 in ns."""
        random = np.random.default_rng(SEED)
        self.pool = np.array([0.0, 0.0, STILL]) + DENSITY * sqrt(rate) * random.standard_normal((POOL, 3))
        self._packed = [row.tobytes() for row in self.pool]
        self._start, self._interval = start, NANOSECONDS / rate
        self._message = imu_template()
        self._number_at, self._place = orientation_at(), acceleration_at()

    def stamp(self, number: int) -> int:
        """Return the stamp of a sample, ns."""
        return self._start + round(number * self._interval)

    def message(self, number: int) -> bytes:
        """Return a message."""
        message, packed = self._message, self._packed[number % POOL]
        STAMP.pack_into(message, STAMP_AT, *divmod(self.stamp(number), NANOSECONDS))
        NUMBER.pack_into(message, self._number_at, number)
        message[self._place : self._place + len(packed)] = packed
        return bytes(message)

    def received(self, messages: list[bytes]) -> "Received":
        """Return what messages that have come back are; raises RuntimeError where one is not as long as was sent."""
        size = len(self._message)
        if any(len(message) != size for message in messages):
            raise RuntimeError("a message came back with another length")
        table = np.frombuffer(b"".join(messages), dtype=np.uint8).reshape(-1, size)
        numbers = _doubles(table, self._number_at, 1)[:, 0].astype(np.int64)
        changed = (_doubles(table, self._place, 3) != self.pool[numbers % POOL]).all(axis=1)
        return Received(numbers, int(changed.sum()))


@dataclass(frozen=True)
class Received:
    """numbers: (n,) of the messages, in the order in which they came. changed: how many have other accelerations."""

    numbers: NDArray[np.int64]
    changed: int

    def lost(self, sent: int) -> int:
        """Return how many of the first ``sent`` have not come."""
        return sent - len(np.unique(self.numbers))


def _doubles(table: NDArray[np.uint8], place: int, count: int) -> NDArray[np.float64]:
    return np.ascontiguousarray(table[:, place : place + 8 * count]).view(np.float64)
