"""Which Kalman stage a channel has."""

from dataclasses import dataclass
from enum import Enum

from hgma_compensation.kalman.random_walk import RandomWalkNoise

GATE_THRESHOLD = 6.0
"""Standard deviations: a false opening once in 10⁸ samples, each of which costs the smoothing of 192."""


class FilterMode(str, Enum):
    """What the stage does with the acceleration after the drift model.

    OFF: nothing. SMOOTH: the output is the filtered acceleration, and the raw one while something happens.
    BIAS: the output is the raw acceleration less a slow bias, which is learned at rest.
    """

    OFF = "off"
    SMOOTH = "smooth"
    BIAS = "bias"


@dataclass(frozen=True)
class FilterSettings:
    """Mode of a channel's stage; noise where it is on.

    threshold: of the gate, in standard deviations. wander: standard deviation of the level at rest that is
    not white noise (flicker, and what the drift model leaves), in the channel's unit: the gate does not
    take it for motion. initial_bias: standard deviation of the bias before
    anything is known of it, in the channel's unit; used by BIAS only.
    """

    mode: FilterMode = FilterMode.OFF
    noise: RandomWalkNoise | None = None
    threshold: float = GATE_THRESHOLD
    wander: float = 0.0
    initial_bias: float = 0.0
