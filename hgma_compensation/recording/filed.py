"""A recording whose samples wait in temporary files: read once, looked at in parts as often as need be."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hgma_compensation import topics
from hgma_compensation.channels import CHANNELS
from hgma_compensation.progress import Advance
from hgma_compensation.recording.bag_reader import read_bag
from hgma_compensation.recording.batch import Indices
from hgma_compensation.recording.reading import Samples
from hgma_compensation.recording.recording import Series, no_thermistor
from hgma_compensation.recording.sliced import Column, Sliced, in_parts
from hgma_compensation.recording.spooled import AT_ONCE, Spooled
from hgma_compensation.stamps import NANOSECONDS, Stamps


@dataclass(frozen=True)
class FiledRecording:
    """One run of one sensor; the attributes are those of Recording.

    first, last: least and greatest stamp of the accelerometer, ns.
    """

    name: str
    stamps: Sliced
    values: Sliced
    present: tuple[str, ...]
    temperature: Series
    temperature_2: Series = field(default_factory=Series.empty)
    supply_voltage: Series = field(default_factory=Series.empty)
    frame: str = "imu_link"
    block: Sliced | None = None
    first: int = 0
    last: int = 0

    @property
    def start(self) -> int:
        """Stamp of the first sample of accelerometer or thermistor, ns."""
        return int(self.temperature.stamps.min(initial=self.first))

    @property
    def duration(self) -> float:
        """Time from the first to the last accelerometer sample, s."""
        return (self.last - self.first) / NANOSECONDS

    @property
    def samples(self) -> int:
        """Number of accelerometer samples."""
        return len(self.stamps)

    def windows(self) -> Iterator[tuple[Stamps, NDArray[np.float64]]]:
        """Yield stamps (n,) and values (n, 6) of the accelerometer samples."""
        for part in in_parts(self.samples, AT_ONCE):
            yield self.stamps[part], self.values[part]

    def require_temperature(self) -> None:
        """Raise RefusedError where there is no thermistor in the recording."""
        if not len(self.temperature.stamps):
            raise no_thermistor(self.name)

    def has(self, name: str) -> bool:
        """Return whether there is a finite sample of a slow input, named as its field is."""
        return bool(np.isfinite(getattr(self, name).values).any())


def file_recording(
    path: Path, names: topics.TopicNames | None = None, progress: Advance | None = None
) -> FiledRecording:
    """Return a bag as a recording whose samples wait in temporary files; refuses what ``read_recording`` does.

    Raises RefusedError where there is no room for the files, too: 56 bytes a sample, 64 of blocks.
    """
    read, samples = read_bag(path, names, progress, _Filed())
    return FiledRecording(
        name=read.name,
        stamps=Column(samples.stamps, 0),
        values=samples.values,
        present=read.present,
        frame=read.frame,
        block=Column(samples.block, 0) if len(samples.block) else None,
        first=samples.first,
        last=samples.last,
        **read.series,
    )


class _Filed(Samples):
    """Samples as they are read, put into files."""

    def __init__(self) -> None:
        super().__init__()
        self.stamps, self.values, self.block = Spooled(1, np.int64), Spooled(len(CHANNELS)), Spooled(1, np.int64)
        self.first, self.last = int(np.iinfo(np.int64).max), int(np.iinfo(np.int64).min)
        self._blocks = 0

    def __len__(self) -> int:
        return len(self.stamps)

    def add(self, stamps: Stamps, values: NDArray[np.float64], counts: Indices | None) -> None:
        super().add(stamps, values, counts)
        self.stamps.add(stamps[:, None])
        self.values.add(values)
        if counts is not None:
            numbers = self._blocks + np.arange(len(counts))
            self.block.add(np.repeat(numbers, counts)[:, None])
            self._blocks += len(counts)
        if len(stamps):
            self.first, self.last = min(self.first, int(stamps.min())), max(self.last, int(stamps.max()))
