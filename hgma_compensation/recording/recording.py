"""A recording as arrays."""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.channels import CHANNELS, group_of
from hgma_compensation.errors import RefusedError
from hgma_compensation.stamps import NANOSECONDS, Stamps, to_nanoseconds


@dataclass(frozen=True)
class Series:
    """Scalar samples: stamps (n,) in ns, values (n,)."""

    stamps: Stamps
    values: NDArray[np.float64]

    @classmethod
    def empty(cls) -> "Series":
        """Return a series without samples."""
        return cls(np.empty(0, dtype=np.int64), np.empty(0))

    def between(self, start: int, end: int) -> "Series":
        """Return the samples with start <= stamp < end (ns)."""
        inside = (self.stamps >= start) & (self.stamps < end)
        return Series(self.stamps[inside], self.values[inside])


@dataclass(frozen=True)
class Extent:
    """When a recording was made. start: ns. duration: s."""

    name: str
    start: int
    duration: float

    def span(self, start: float | None, end: float | None) -> tuple[int, int]:
        """Return the stamps [first, last) in ns from start to before end, in s from the start of the recording."""
        last = self.start + to_nanoseconds(end) if end is not None else int(np.iinfo(np.int64).max)
        return self.start + to_nanoseconds(start or 0.0), last

    def nothing_left(self, start: float | None, end: float | None) -> RefusedError:
        """Return the refusal of a part without samples."""
        until = "its end" if end is None else f"{end:g} s"
        return RefusedError(
            f"{self.name} has no sample from {start or 0:g} s until {until}: it lasts {self.duration:.1f} s"
        )


@dataclass(frozen=True)
class Recording:
    """One run of one sensor.

    stamps: (n,) ns of the accelerometer. values: (n, 6), columns CHANNELS, m/s² and rad/s.
    present: the channels that the sensor really delivers. temperature, temperature_2: °C.
    supply_voltage: V. frame: of the accelerometer's messages. name: for messages and provenance. block: (n,) number of
    the AccelBlock that each sample came in, None where each came in a message of its own.
    """

    name: str
    stamps: Stamps
    values: NDArray[np.float64]
    present: tuple[str, ...]
    temperature: Series
    temperature_2: Series = field(default_factory=Series.empty)
    supply_voltage: Series = field(default_factory=Series.empty)
    frame: str = "imu_link"
    block: NDArray[np.int64] | None = None

    @property
    def start(self) -> int:
        """Stamp of the first sample of accelerometer or thermistor, ns."""
        return int(self.temperature.stamps.min(initial=self.first))

    @property
    def first(self) -> int:
        """Least stamp of the accelerometer, ns."""
        return int(self.stamps.min())

    @property
    def last(self) -> int:
        """Greatest stamp of the accelerometer, ns."""
        return int(self.stamps.max())

    @property
    def duration(self) -> float:
        """Time from the first to the last accelerometer sample, s."""
        return (self.last - self.first) / NANOSECONDS

    @property
    def samples(self) -> int:
        """Number of accelerometer samples."""
        return len(self.stamps)

    def windows(self) -> Iterator[tuple[Stamps, NDArray[np.float64]]]:
        """Yield stamps (n,) and values (n, 6) of the accelerometer samples: here all at once."""
        yield self.stamps, self.values

    def cut(self, start: float | None, end: float | None) -> "Recording":
        """Return the part from start to before end, in s from the start of the recording.

        Raises RefusedError where nothing is left.
        """
        if start is None and end is None:
            return self
        extent = Extent(self.name, self.start, self.duration)
        first, last = extent.span(start, end)
        inside = (self.stamps >= first) & (self.stamps < last)
        if not inside.any():
            raise extent.nothing_left(start, end)
        return replace(
            self,
            stamps=self.stamps[inside],
            values=self.values[inside],
            block=None if self.block is None else self.block[inside],
            temperature=self.temperature.between(first, last),
            temperature_2=self.temperature_2.between(first, last),
            supply_voltage=self.supply_voltage.between(first, last),
        )

    def require_temperature(self) -> None:
        """Raise RefusedError where there is no thermistor in the recording."""
        if not len(self.temperature.stamps):
            raise no_thermistor(self.name)

    def has(self, name: str) -> bool:
        """Return whether there is a finite sample of a slow input, named as its field is."""
        return bool(np.isfinite(getattr(self, name).values).any())


def no_thermistor(name: str) -> RefusedError:
    """Return the refusal of a recording without a thermistor."""
    return RefusedError(
        f"{name} holds no thermistor sample: record /accel/temperature beside the accelerometer, "
        "or name the topic with --remap /accel/temperature:=/your/topic"
    )


def present_channels(not_zero: NDArray[np.bool_], absent_groups: set[str]) -> tuple[str, ...]:
    """Return the channels that carry something: not flagged absent, not zero throughout; not_zero: (6,)."""
    return tuple(
        channel
        for column, channel in enumerate(CHANNELS)
        if group_of(channel) not in absent_groups and not_zero[column]
    )
