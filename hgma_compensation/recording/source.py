"""What is asked of a recording, be it in memory, in a file or left in its bag."""

from collections.abc import Iterator
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.recording.recording import Series
from hgma_compensation.stamps import Stamps


class Source(Protocol):
    """The attributes are those of Recording."""

    @property
    def name(self) -> str:
        """Name, for messages and provenance."""

    @property
    def frame(self) -> str:
        """Frame of the accelerometer's messages."""

    @property
    def present(self) -> tuple[str, ...]:
        """The channels that the sensor really delivers."""

    @property
    def temperature(self) -> Series:
        """The thermistor, °C."""

    @property
    def start(self) -> int:
        """Stamp of the first sample of accelerometer or thermistor, ns."""

    @property
    def duration(self) -> float:
        """Time from the first to the last accelerometer sample, s."""

    @property
    def samples(self) -> int:
        """Number of accelerometer samples."""

    def require_temperature(self) -> None:
        """Raise RefusedError where there is no thermistor."""

    def windows(self) -> Iterator[tuple[Stamps, NDArray[np.float64]]]:
        """Yield stamps (n,), ns, and values (n, 6), columns CHANNELS, of the accelerometer samples in their order."""
