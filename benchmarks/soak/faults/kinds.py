"""The faults: each changes a segment as a broken sensor, driver, clock or operator would.

Each names the counters of the diagnostics of which at least one must have grown by the end.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np

from benchmarks.soak.faults.segment import Action, Block, Item, Sample, Slow
from hgma_compensation import topics
from hgma_compensation.stamps import NANOSECONDS, to_nanoseconds

Apply = Callable[[list[Item], np.random.Generator], list[Item]]
Kind = TypeVar("Kind")


@dataclass(frozen=True)
class Fault:
    """How to change a segment, and by what the node must say it; blocks: None where it does to both kinds of stream."""

    apply: Apply
    counters: tuple[str, ...]
    blocks: bool | None = None


def _of(items: Sequence[Item], kind: type[Kind]) -> list[Kind]:
    return [item for item in items if isinstance(item, kind)]


def _one(items: Sequence[Item], kind: type[Kind], random: np.random.Generator) -> Kind:
    found = _of(items, kind)
    return found[int(random.integers(len(found)))]


def _thermistor(items: Sequence[Item]) -> list[Slow]:
    return [item for item in _of(items, Slow) if item.topic == topics.TEMPERATURE]


def _value(*values: float) -> Apply:
    def apply(items: list[Item], random: np.random.Generator) -> list[Item]:
        sample = _one(items, Sample, random)
        sample.values[int(random.integers(3))] = float(random.choice(values))
        return items

    return apply


def _attribute(name: str, value: Any) -> Apply:
    def apply(items: list[Item], random: np.random.Generator) -> list[Item]:
        setattr(_one(items, Sample, random), name, value)
        return items

    return apply


def _slow_value(topic: str, *values: float) -> Apply:
    def apply(items: list[Item], random: np.random.Generator) -> list[Item]:
        found = [item for item in _of(items, Slow) if item.topic == topic]
        found[int(random.integers(len(found)))].value = float(random.choice(values))
        return items

    return apply


def _thermistors(change: Callable[[list[Slow]], None]) -> Apply:
    def apply(items: list[Item], random: np.random.Generator) -> list[Item]:
        change(_thermistor(items))
        return items

    return apply


def _set_all(value: float) -> Callable[[list[Slow]], None]:
    def change(samples: list[Slow]) -> None:
        for sample in samples:
            sample.value = value

    return change


def _shift_all(seconds: float) -> Callable[[list[Slow]], None]:
    def change(samples: list[Slow]) -> None:
        for sample in samples:
            sample.stamp += to_nanoseconds(seconds)

    return change


def _silent(items: list[Item], random: np.random.Generator) -> list[Item]:
    return [item for item in items if not (isinstance(item, Slow) and item.topic == topics.TEMPERATURE)]


def _repeated(items: list[Item], random: np.random.Generator) -> list[Item]:
    place = items.index(_one(items, Sample, random))
    twin = items[place]
    assert isinstance(twin, Sample)
    return [*items[:place], Sample(twin.stamp, list(twin.values)), *items[place:]]


def _out_of_order(items: list[Item], random: np.random.Generator) -> list[Item]:
    samples = _of(items, Sample)
    number = int(random.integers(len(samples) - 1))
    one, other = samples[number], samples[number + 1]
    one.stamp, other.stamp = other.stamp, one.stamp
    return items


def _future(items: list[Item], random: np.random.Generator) -> list[Item]:
    _one(items, Sample, random).stamp += 10**6 * NANOSECONDS
    return items


def _future_thermistor(items: list[Item], random: np.random.Generator) -> list[Item]:
    samples = _thermistor(items)
    samples[int(random.integers(1, len(samples) - 1))].stamp += 10**6 * NANOSECONDS
    return items


def _shock(items: list[Item], random: np.random.Generator) -> list[Item]:
    samples = _of(items, Sample)
    begin = int(random.integers(len(samples) - 5))
    for sample in samples[begin : begin + 5]:
        sample.values[:3] = [value + random.choice([-1.0, 1.0]) * 1e4 for value in sample.values[:3]]
    return items


def _block_values(items: list[Item], random: np.random.Generator) -> list[Item]:
    block = _one(items, Block, random)
    block.axes[int(random.integers(3))][int(random.integers(len(block.axes[0])))] = random.choice([np.nan, np.inf])
    return items


def _block_uneven(items: list[Item], random: np.random.Generator) -> list[Item]:
    block = _one(items, Block, random)
    block.axes[1] = block.axes[1][:-1]
    return items


def _block_interval(items: list[Item], random: np.random.Generator) -> list[Item]:
    _one(items, Block, random).interval = float(random.choice([0.0, -1.0, np.nan]))
    return items


def _block_empty(items: list[Item], random: np.random.Generator) -> list[Item]:
    block = _one(items, Block, random)
    block.axes = [axis[:0] for axis in block.axes]
    return items


def _action(name: str) -> Apply:
    def apply(items: list[Item], random: np.random.Generator) -> list[Item]:
        place = int(random.integers(len(items)))
        return [*items[:place], Action(name), *items[place:]]

    return apply


def _inactive(items: list[Item], random: np.random.Generator) -> list[Item]:
    first, last = sorted(random.integers(len(items), size=2).tolist())
    return [*items[:first], Action("deactivate"), *items[first:last], Action("activate"), *items[last:]]


NOT_A_NUMBER = [float("nan")] + [0.0] * 8
NEGATIVE = [1.0] + [-2.0] * 8
ABSENT = [-1.0] + [0.0] * 8

FAULTS: dict[str, Fault] = {
    "acceleration NaN": Fault(_value(np.nan), ("acceleration_not_finite",), False),
    "acceleration infinite": Fault(_value(np.inf, -np.inf), ("acceleration_not_finite",), False),
    "acceleration absurd": Fault(_value(1e7, -1e30, 1e308), ("acceleration_implausible",), False),
    "acceleration absent": Fault(_attribute("covariance", ABSENT), ("acceleration_absent",), False),
    "covariance NaN": Fault(_attribute("covariance", NOT_A_NUMBER), ("acceleration_covariance_invalid",), False),
    "covariance negative": Fault(_attribute("covariance", NEGATIVE), ("acceleration_covariance_invalid",), False),
    "frame changes": Fault(_attribute("frame", "another_link"), ("acceleration_frame_changed",), False),
    "stamp zero": Fault(_attribute("stamp", 0), ("acceleration_not_stamped",), False),
    "stamp negative": Fault(_attribute("stamp", -5 * NANOSECONDS), ("acceleration_not_stamped",), False),
    "stamp repeated": Fault(_repeated, ("acceleration_stamp_repeated",), False),
    "stamps out of order": Fault(_out_of_order, ("acceleration_out_of_order",), False),
    "stamp from the future": Fault(_future, ("acceleration_clock_was_ahead",), False),
    "shock": Fault(_shock, (), False),
    "thermistor NaN": Fault(_slow_value(topics.TEMPERATURE, np.nan, np.inf), ("temperature_not_finite",)),
    "thermistor implausible": Fault(_slow_value(topics.TEMPERATURE, 300.0, -200.0), ("temperature_implausible",)),
    "thermistor jumps": Fault(_slow_value(topics.TEMPERATURE, 120.0, -80.0), ("temperature_jumped",)),
    "thermistor stuck": Fault(_thermistors(_set_all(31.25)), ("temperature_stuck", "temperature_jumped")),
    "thermistor silent": Fault(_silent, ("temperature_status_stale",)),
    "thermistor out of range": Fault(_thermistors(_set_all(95.0)), ("temperature_status_out_of_range",)),
    "thermistor behind": Fault(_thermistors(_shift_all(-20.0)), ("temperature_clock_set_back", "temperature_late")),
    "thermistor ahead": Fault(_thermistors(_shift_all(100.0)), ("temperature_ahead",)),
    "thermistor not stamped": Fault(_thermistors(lambda s: setattr(s[24], "stamp", 0)), ("temperature_not_stamped",)),
    "thermistor stamp repeated": Fault(
        _thermistors(lambda s: setattr(s[25], "stamp", s[24].stamp)), ("temperature_stamp_repeated",)
    ),
    "thermistor stamp from the future": Fault(_future_thermistor, ("temperature_clock_was_ahead",)),
    "second thermometer NaN": Fault(_slow_value(topics.TEMPERATURE_2, np.nan), ("temperature_2_not_finite",)),
    "voltage absurd": Fault(_slow_value(topics.SUPPLY_VOLTAGE, -5.0, 1e9), ("supply_voltage_implausible",)),
    "block NaN": Fault(_block_values, ("acceleration_not_finite",), True),
    "block uneven": Fault(_block_uneven, ("block_malformed",), True),
    "block interval": Fault(_block_interval, ("block_malformed",), True),
    "block empty": Fault(_block_empty, (), True),
    "calibration swapped": Fault(_action("swap"), ()),
    "calibration refused": Fault(_action("refuse"), ()),
    "reset": Fault(_action("reset"), ()),
    "deactivated": Fault(_inactive, ("node_not_active",)),
}
"""Those of the clock of both streams together are the stream's: see there."""
