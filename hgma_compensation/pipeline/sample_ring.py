"""The newest samples of a slow input, in memory that is taken once and copied in microseconds."""

from array import array
from collections.abc import Iterator

Pair = tuple[int, float]
"""Stamp in ns, and value."""

Series = tuple["array[int]", "array[float]"]
"""Stamps in ns and values of the same samples."""


class SampleRing:
    """The newest samples up to a capacity, oldest first; one more pushes the oldest out.

    Arrays, not tuples of numbers: an hour of samples is copied, and sent to another process, as a piece of memory.
    """

    def __init__(self, capacity: int) -> None:
        """Take the memory for ``capacity`` samples."""
        self._stamps, self._values = array("q", bytes(8 * capacity)), array("d", bytes(8 * capacity))
        self._capacity = capacity
        self.clear()

    def clear(self) -> None:
        """Forget all samples."""
        self._begin = self._count = 0

    def __len__(self) -> int:
        """Return the number of samples that are held."""
        return self._count

    @property
    def full(self) -> bool:
        """Whether the next sample pushes the oldest out."""
        return self._count == self._capacity

    def __getitem__(self, index: int) -> Pair:
        """Return the sample at an index, 0 for the oldest, -1 for the newest; raises IndexError."""
        if not -self._count <= index < self._count:
            raise IndexError(f"sample {index} of {self._count}")
        place = (self._begin + (index if index >= 0 else self._count + index)) % self._capacity
        return self._stamps[place], self._values[place]

    def __iter__(self) -> Iterator[Pair]:
        """Yield the samples that are held now, oldest first."""
        return zip(*self.newest(self._count), strict=True)

    def append(self, stamp: int, value: float) -> None:
        """Take a sample."""
        place = (self._begin + self._count) % self._capacity
        self._stamps[place], self._values[place] = stamp, value
        if self.full:
            self._begin = (self._begin + 1) % self._capacity
        else:
            self._count += 1

    def newest(self, count: int) -> Series:
        """Return a copy of the last ``count`` samples that are held, oldest first."""
        first = (self._begin + self._count - count) % self._capacity
        last, rest = first + count, max(first + count - self._capacity, 0)
        return self._stamps[first:last] + self._stamps[:rest], self._values[first:last] + self._values[:rest]

    def copy_from(self, other: "SampleRing") -> None:
        """Hold what another ring of the same capacity holds now."""
        self._stamps[:], self._values[:] = other._stamps, other._values
        self._begin, self._count = other._begin, other._count
