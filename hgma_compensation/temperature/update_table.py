"""Rows in the order of their stamps, of which a stream drops the oldest; and which of them a reading uses."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.stamps import Stamps

Array = NDArray[np.float64]

ROOM = 256
"""Rows that there is room for at the start."""


MANY = 256
"""Stamps from which on it pays to look first if all of them lie between the same two rows."""


class UpdateTable:
    """Stamp, stamp of the power-on and ``width`` values of each update."""

    def __init__(self, width: int, keep: int | None) -> None:
        """Start empty; keep: ns of history to hold on to, None for all of it."""
        self._width, self._keep = width, keep
        self.clear()

    def clear(self) -> None:
        """Drop all rows."""
        self._allocate(ROOM)
        self._size = 0

    def _allocate(self, capacity: int) -> None:
        self._stamps, self._power_on = np.empty(capacity, dtype=np.int64), np.empty(capacity, dtype=np.int64)
        self._values = np.empty((capacity, self._width))

    def __len__(self) -> int:
        """Return the number of rows n that are held."""
        return self._size

    @property
    def stamps(self) -> Stamps:
        """Stamps (n,), ns."""
        return self._stamps[: self._size]

    @property
    def power_on(self) -> Stamps:
        """Stamps of the power-on before each update (n,), ns."""
        return self._power_on[: self._size]

    @property
    def values(self) -> Array:
        """Values (n, width)."""
        return self._values[: self._size]

    def append(self, stamp: int, power_on: int, values: Array, needed_from: int) -> None:
        """Add a row of values (width,); needed_from: stamp whose history, too, is to be held on to, ns."""
        if self._size == len(self._stamps):
            self._make_room(min(stamp, needed_from))
        self._stamps[self._size], self._power_on[self._size] = stamp, power_on
        self._values[self._size] = values
        self._size += 1

    def truncate(self, rows: int) -> None:
        """Drop all rows but the first ones."""
        self._size = rows

    def shift(self, nanoseconds: int) -> None:
        """Move the stamps of all rows."""
        self.stamps[:] += nanoseconds
        self.power_on[:] += nanoseconds

    def _make_room(self, now: int) -> None:
        """Drop what is older than the history to keep; grow only if that frees less than half."""
        drop = 0 if self._keep is None else self.reachable(now - self._keep)
        kept = self._size - drop
        capacity = len(self._stamps) if 2 * kept <= self._size else 2 * len(self._stamps)
        self.hold(self.stamps[drop:], self.power_on[drop:], self.values[drop:], capacity)

    def reachable(self, since: int) -> int:
        """Return the oldest row that readings from a stamp (ns) on are predicted from: it may be older than that."""
        return max(0, int(np.searchsorted(self.stamps, since, side="right")) - 1)

    def used(self, stamps: Stamps, latency: int) -> NDArray[np.int64]:
        """Return the row (n,) that a reading at each stamp (n,) uses: the newest that is as old as the latency, ns.

        A power-on begins anew: from its stamp on no row before it is used, though it be younger than the latency.
        The oldest row where there is no other; raises IndexError without any.
        """
        index = self._newest_at(stamps - latency)
        if self.power_on[0] == self.power_on[-1]:
            return np.asarray(np.maximum(index, 0))
        newest = np.maximum(self._newest_at(stamps), 0)
        return np.asarray(np.maximum(index, self.stamps.searchsorted(self.power_on[newest])))

    def _newest_at(self, stamps: Stamps) -> NDArray[np.int64]:
        """Return the newest row (n,) that is not later than each stamp (n,), -1 where there is none."""
        if len(stamps) > MANY:
            # A block is shorter than the time between two rows, mostly.
            low, high = self.stamps.searchsorted((stamps.min(), stamps.max()), side="right").tolist()
            if low == high:
                return np.full(len(stamps), low - 1, dtype=np.int64)
        return np.asarray(self.stamps.searchsorted(stamps, side="right") - 1)

    def adopted(self, low: int, high: int, latency: int) -> Stamps:
        """Return the stamps in low < s < high (ns) at which ``used`` goes on to another row, and some at which not."""
        begin, end = self.stamps.searchsorted((low - latency, high)).tolist()
        stamps = self.stamps[begin:end]
        # A row that begins a time with power is used from its own stamp on.
        begun = stamps[self.power_on[begin:end] == stamps]
        both = np.concatenate([stamps + latency, begun])
        return both[(both > low) & (both < high)]

    def snapshot(self, since: int) -> dict[str, Any]:
        """Return, as plain JSON, the rows that readings from a stamp (ns) on depend on."""
        rows = slice(self.reachable(since), None)
        return {
            "stamps": self.stamps[rows].tolist(),
            "power_on": self.power_on[rows].tolist(),
            "values": self.values[rows].tolist(),
        }

    def restore(self, snapshot: dict[str, Any]) -> None:
        """Hold the rows of a snapshot and no others; raises ValueError where it is none."""
        stamps, power_on = (np.array(snapshot[name], dtype=np.int64) for name in ("stamps", "power_on"))
        values = np.array(snapshot["values"], dtype=np.float64).reshape(len(stamps), self._width)
        if not np.isfinite(values).all() or np.any(np.diff(stamps) <= 0):
            raise ValueError("numbers that are not finite, or stamps that do not increase")
        self.hold(stamps, power_on, values, 2 * len(stamps))

    def hold(self, stamps: Stamps, power_on: Stamps, values: Array, capacity: int) -> None:
        """Hold these rows and no others, with room for more; raises ValueError where the shapes do not fit."""
        self._allocate(max(capacity, ROOM))
        self._size = len(stamps)
        self.stamps[:], self.power_on[:], self.values[:] = stamps, power_on, values
