"""Which Kalman stage a channel has."""

from dataclasses import dataclass
from enum import Enum

from hgma_compensation.kalman.random_walk import RandomWalkNoise


class FilterMode(str, Enum):
    """OFF: the drift is removed and nothing else. SMOOTH: the output is the filtered acceleration."""

    OFF = "off"
    SMOOTH = "smooth"


@dataclass(frozen=True)
class FilterSettings:
    """Mode of a channel's filter, and its noise where it is on."""

    mode: FilterMode = FilterMode.OFF
    noise: RandomWalkNoise | None = None
