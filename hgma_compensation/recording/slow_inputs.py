"""The slow inputs of a bag: thermometers and supply voltage, as columns."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from hgma_compensation import topics
from hgma_compensation.cdr.scalar import SUPPLY_VOLTAGE_DOUBLES, TEMPERATURE_DOUBLES, scalar_columns
from hgma_compensation.effects.effect import Need
from hgma_compensation.messages import stamp_of
from hgma_compensation.recording import typestore as types
from hgma_compensation.recording.batch import Batch
from hgma_compensation.recording.recording import Series


class SlowInput(NamedTuple):
    """need: None for the thermistor. series: its name in a Recording. field, doubles: of its message."""

    need: Need | None
    series: str
    topic: str
    message_type: str
    field: str
    doubles: int


SLOW_INPUTS = (
    SlowInput(None, "temperature", topics.TEMPERATURE, types.TEMPERATURE, "temperature", TEMPERATURE_DOUBLES),
    SlowInput(
        Need.TEMPERATURE_2,
        "temperature_2",
        topics.TEMPERATURE_2,
        types.TEMPERATURE,
        "temperature",
        TEMPERATURE_DOUBLES,
    ),
    SlowInput(
        Need.SUPPLY_VOLTAGE,
        "supply_voltage",
        topics.SUPPLY_VOLTAGE,
        types.SUPPLY_VOLTAGE,
        "voltage",
        SUPPLY_VOLTAGE_DOUBLES,
    ),
)


def read_slow(batch: Batch, slow: SlowInput, decode: Callable[[bytes], Any]) -> Series:
    """Return stamps and values of the messages of one slow input."""
    stamps, values = np.empty(len(batch), dtype=np.int64), np.empty(len(batch))
    for rows in batch.same_sizes():
        some = batch.select(rows)
        columns = scalar_columns(some.rows(), slow.doubles)
        if columns is None:
            messages = [decode(raw) for raw in some.raws()]
            columns = _of_messages(messages, slow.field)
        stamps[rows], values[rows] = columns
    return Series(stamps, values)


def _of_messages(messages: list[Any], field: str) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    stamps = np.array([stamp_of(message) for message in messages], dtype=np.int64)
    return stamps, np.array([getattr(message, field) for message in messages], dtype=np.float64)
