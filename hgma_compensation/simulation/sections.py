"""Oven, power, thermometers, supply and axes of a scenario's document, as objects."""

from collections.abc import Mapping
from typing import Any

from hgma_compensation.channels import AXES
from hgma_compensation.errors import RefusedError
from hgma_compensation.recording.csv_table import STANDARD_GRAVITY
from hgma_compensation.simulation.description import (
    Axis,
    Heating,
    Oven,
    Powered,
    Ripple,
    Step,
    Supply,
    Thermometer,
    VoltageStep,
)

Document = Mapping[str, Any]

PAPER_UNITS = {
    "drift_span_g": ("drift_span", STANDARD_GRAVITY),
    "full_scale_g": ("full_scale", STANDARD_GRAVITY),
    "white_noise_g_per_h": ("white_noise", STANDARD_GRAVITY / 3600.0),
    "bias_instability_g_per_h": ("bias_instability", STANDARD_GRAVITY / 3600.0),
}
"""Fields in the units of the paper's table, g and g/h (g per second times 3600), and what they are in SI."""


def decode_oven(document: Document) -> Oven:
    """Return the oven."""
    rest = {name: value for name, value in document.items() if name not in ("program", "ripple")}
    ripple = Ripple(**document["ripple"]) if "ripple" in document else None
    return Oven(program=tuple(Step(**step) for step in document["program"]), ripple=ripple, **rest)


def decode_powered(entries: list[Document], duration: float) -> tuple[Powered, ...]:
    """Return the intervals of power; raises RefusedError where they overlap or lie outside of the programme."""
    powered, before = tuple(Powered(**entry) for entry in entries), 0.0
    for index, interval in enumerate(powered):
        if not before <= interval.start < min(interval.end, duration):
            raise RefusedError(
                f"power[{index}] must start at {before:g} s or later, before its end and before {duration:g} s"
            )
        before = interval.end
    return powered


def decode_thermometer(document: Document) -> Thermometer:
    """Return a thermometer."""
    heating = tuple(Heating(**entry) for entry in document.get("heating", ()))
    return Thermometer(**{**document, "heating": heating})


def decode_supply(document: Document) -> Supply:
    """Return the supply."""
    return Supply(**{**document, "steps": tuple(VoltageStep(**entry) for entry in document.get("steps", ()))})


def decode_axes(document: Document) -> dict[str, Axis]:
    """Return the axes; raises RefusedError where there is none."""
    if not document:
        raise RefusedError("accelerometer.axes is empty: describe at least one of x, y, z")
    return {axis: _axis(document[axis], f"accelerometer.axes.{axis}") for axis in AXES if axis in document}


def _axis(document: Document, path: str) -> Axis:
    fields = {}
    for name, value in document.items():
        plain, factor = PAPER_UNITS.get(name, (name, 1.0))
        if plain in fields:
            raise RefusedError(f"{path} gives {plain} twice, in two units: keep one of them")
        fields[plain] = value * factor
    return Axis(**fields)


def check_times(document: Document, duration: float) -> None:
    """Raise RefusedError naming the first event that ends before it starts, or that the programme is too short for."""
    motion = document.get("motion", {})
    lists = {f"motion.{name}": entries for name, entries in motion.items()}
    lists["second_thermometer.heating"] = document.get("second_thermometer", {}).get("heating", [])
    lists["supply_voltage.steps"] = document.get("supply_voltage", {}).get("steps", [])
    for path, entries in lists.items():
        for index, entry in enumerate(entries):
            start = entry.get("time", entry.get("start"))
            if start >= duration:
                raise RefusedError(f"{path}[{index}] is at {start:g} s, but oven.program ends at {duration:g} s")
            if "end" in entry and entry["end"] <= start:
                raise RefusedError(f"{path}[{index}].end is not after its start")
