"""What a scenario lets the sensor undergo, in m/s². Times are s from the beginning of the oven's programme."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Orientation:
    """Specific force (m/s², x y z) held from a time (s) on, turned to within turn s."""

    time: float
    specific_force: tuple[float, float, float]
    turn: float = 1.0


@dataclass(frozen=True)
class Shock:
    """Half-sine: time of its beginning (s), signed peak (m/s²), width at the base (s)."""

    time: float
    axis: str
    peak: float
    width: float


@dataclass(frozen=True)
class Vibration:
    """Tone (low == high) or band of Gaussian noise from low to high Hz; rms in m/s²."""

    start: float
    end: float
    axis: str
    rms: float
    low: float
    high: float


@dataclass(frozen=True)
class Waveform:
    """Measured acceleration: times (k,) in s of the recording, values (k,) in m/s²."""

    axis: str
    times: NDArray[np.float64]
    values: NDArray[np.float64]


@dataclass(frozen=True)
class Motion:
    """Everything that the sensor really undergoes."""

    orientations: tuple[Orientation, ...] = ()
    shocks: tuple[Shock, ...] = ()
    vibrations: tuple[Vibration, ...] = ()
    waveforms: tuple[Waveform, ...] = ()
