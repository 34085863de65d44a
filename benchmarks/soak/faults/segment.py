"""Ten seconds of a sensor's stream as a list of what is sent, in the order of sending."""

from dataclasses import dataclass, field
from math import cos, pi, sin

import numpy as np

from hgma_compensation import topics
from hgma_compensation.stamps import NANOSECONDS, to_nanoseconds

SECONDS = 10.0
BLOCK_RATE, BLOCK_LENGTH = 1000, 100
"""Hz, and samples of one block."""

START = 1_700_000_000 * NANOSECONDS
CYCLE = 1800.0
"""s of one oven cycle."""

SLOW_RATES = {topics.TEMPERATURE: 5.0, topics.TEMPERATURE_2: 1.0, topics.SUPPLY_VOLTAGE: 1.0}
"""Hz."""


@dataclass
class Sample:
    """One Imu: m/s², covariance of the acceleration (m/s²)²; number: of the sample in the whole stream."""

    stamp: int
    values: list[float]
    number: int = 0
    frame: str = "imu_link"
    covariance: list[float] = field(default_factory=lambda: [0.01, 0.0, 0.0, 0.0, 0.01, 0.0, 0.0, 0.0, 0.01])


@dataclass
class Block:
    """One AccelBlock."""

    stamp: int
    axes: list[np.ndarray]
    interval: float = 1.0 / BLOCK_RATE
    frame: str = "imu_link"


@dataclass
class Slow:
    """One sample of a slow input: °C or V."""

    topic: str
    stamp: int
    value: float


@dataclass
class Action:
    """What is done to the node between two messages: a name that the peer knows."""

    name: str


Item = Sample | Block | Slow | Action


def celsius(seconds: float) -> float:
    """Return the temperature of the oven at a time of the stream, inside the calibrated range."""
    return 25.0 - 34.0 * cos(2.0 * pi * seconds / CYCLE)


def drift(temperature: float) -> float:
    """Return what the simulated sensor drifts, m/s²."""
    x = (temperature - 25.0) / 35.0
    return 20.0 * x + 5.0 * sin(2.0 * x)


def clean_segment(begin: float, rate: float, random: np.random.Generator, *, blocks: bool) -> list[Item]:
    """Return the stream from ``begin`` s on; rate: Hz of the messages; blocks: samples in blocks instead."""
    items: list[Item] = []
    for topic, slow_rate in SLOW_RATES.items():
        for second in begin + np.arange(int(SECONDS * slow_rate)) / slow_rate:
            value = 5.0 if topic == topics.SUPPLY_VOLTAGE else celsius(second) + 0.01 * random.standard_normal()
            items.append(Slow(topic, _stamp(second), value + 0.001 * random.standard_normal()))
    level = 9.81 + drift(celsius(begin))
    if blocks:
        for number in range(int(SECONDS * BLOCK_RATE / BLOCK_LENGTH)):
            axes = [(level + 0.5 * random.standard_normal(BLOCK_LENGTH)).astype(np.float32) for _ in range(3)]
            items.append(Block(_stamp(begin + number * BLOCK_LENGTH / BLOCK_RATE), axes))
    else:
        for second in begin + np.arange(int(SECONDS * rate)) / rate:
            items.append(Sample(_stamp(second), [level + 0.1 * random.standard_normal() for _ in range(6)]))
    # Of equal stamps the slow input is sent first, as a driver of both does.
    return sorted(items, key=_order)


def _order(item: Item) -> tuple[int, bool]:
    assert not isinstance(item, Action)
    return item.stamp, not isinstance(item, Slow)


def _stamp(seconds: float) -> int:
    return START + to_nanoseconds(seconds)
