"""A window of a node's topics as figures, and those as a line."""

from typing import Any

from hgma_compensation.channels import CHANNELS, unit_of
from hgma_compensation.quantities import quantity
from hgma_compensation.watching.window import Window

STATUS = ("OK", "SETTLING", "STALE", "MISSING", "OUT_OF_RANGE", "INVALID")
FILTER = ("off", "smooth", "bias")
LEVEL = ("OK", "WARN", "ERROR", "STALE")


def figures(window: Window, seconds: float) -> dict[str, Any]:
    """Return what was seen within a number of seconds, in SI units and °C; None where nothing is known."""
    state = window.state
    return {
        "seconds": seconds,
        "raw_rate": window.raw.count / seconds,
        "compensated_rate": window.compensated.count / seconds,
        "state_rate": window.states / seconds,
        "temperature": None if state is None else state.temperature,
        "temperature_rate": None if state is None else state.temperature_rate,
        "temperature_status": None if state is None else _named(STATUS, state.temperature_status),
        "inside_calibrated_range": None if state is None else state.inside_calibrated_range,
        "calibration_id": None if state is None else state.calibration_id,
        "condition": None if window.condition is None else window.condition[1],
        "level": None if window.condition is None else _named(LEVEL, window.condition[0]),
        "channels": {name: _channel(window, name) for name in _names(window)},
    }


def line(seen: dict[str, Any]) -> str:
    """Return the figures as one line."""
    parts = [f"raw {seen['raw_rate']:.0f}/s, compensated {seen['compensated_rate']:.0f}/s"]
    if seen["temperature"] is not None:
        parts.append(f"{seen['temperature']:.2f} °C, {60.0 * seen['temperature_rate']:+.2f} °C/min")
        place = "inside" if seen["inside_calibrated_range"] else "OUTSIDE"
        parts.append(f"temperature {seen['temperature_status']}, {place} the calibrated range")
        parts.append(f"calibration {seen['calibration_id'] or 'none'}")
    parts += [
        f"{name} {quantity(channel['raw'], unit_of(name))} -> {quantity(channel['compensated'], unit_of(name))}"
        for name, channel in seen["channels"].items()
    ]
    if seen["level"] not in (None, "OK"):
        parts.append(f"{seen['level']}: {seen['condition']}")
    return " | ".join(parts)


def _names(window: Window) -> list[str]:
    """Return the calibrated channels; the accelerometer's where the node has said nothing yet."""
    if window.state is not None and window.state.channels:
        return [name for name in window.state.channels if name in CHANNELS]
    return [name for name in CHANNELS if name.startswith("linear_acceleration")]


def _channel(window: Window, name: str) -> dict[str, float | None]:
    column = CHANNELS.index(name)
    raw, compensated, deviation = window.raw.mean, window.compensated.mean, window.compensated.deviation
    found: dict[str, float | None] = {
        "raw": None if raw is None else float(raw[column]),
        "compensated": None if compensated is None else float(compensated[column]),
        "deviation": None if deviation is None else float(deviation[column]),
        "drift": None,
        "uncertainty": None,
    }
    state = window.state
    if state is not None and name in state.channels:
        place = list(state.channels).index(name)
        found |= {"drift": float(state.drift[place]), "uncertainty": float(state.uncertainty[place])}
    return found


def _named(names: tuple[str, ...], number: int | bytes) -> str:
    place = number[0] if isinstance(number, bytes) else int(number)
    return names[place] if place < len(names) else str(place)
