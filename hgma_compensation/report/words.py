"""Numbers, units and effects as a page shows them: ``quantities`` says them, here they are set as in print."""

import re
from collections.abc import Sequence
from datetime import datetime, timezone
from typing import Any

from hgma_compensation import quantities
from hgma_compensation.channels import unit_of
from hgma_compensation.effects.effect import Effect
from hgma_compensation.effects.registry import kinds
from hgma_compensation.quantities import STANDARD_GRAVITY, shown_unit

SMALLEST_P = 1e-12
"""Below it a p-value says more about the noise model than about chance."""

DIGITS = 3
"""Significant digits of what a page says; beside the pictures more would only be in the way."""

SPACE = "\u00a0"
"""Between a number and its unit: they stay on one line."""

_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_EXPONENT = re.compile(r"e([+-]\d+)")


def set_in_print(text: str) -> str:
    """Return a number or quantity of ``quantities`` with a true minus, powers of ten, and no place to break it."""
    if text == quantities.UNKNOWN:
        return "–"
    powers = _EXPONENT.sub(lambda found: "·10" + str(int(found.group(1))).translate(_SUPERSCRIPTS), text)
    return powers.replace("-", "−").replace(" ", SPACE)


def number(value: float | None, digits: int = DIGITS) -> str:
    """Return a number with so many digits that count, without an exponent where it can be read without."""
    return set_in_print(quantities.number(value, digits))


def unit(channel: str) -> str:
    """Return the unit of a channel as it is printed."""
    return shown_unit(unit_of(channel))


def measured(value: float | None, its_unit: str, digits: int = DIGITS) -> str:
    """Return a value with its unit."""
    return set_in_print(quantities.quantity(value, its_unit, digits, g_from=float("inf")))


def quantity(value: float | None, channel: str) -> str:
    """Return a value of a channel with its unit, and in g beside it where it is an acceleration of 0.1 g or more."""
    shown = quantities.quantity(value, unit_of(channel), DIGITS, g_from=0.1 * STANDARD_GRAVITY)
    return set_in_print(shown).replace(f"{SPACE}(", " (")


def probability(value: float) -> str:
    """Return a p-value."""
    if value < SMALLEST_P:
        return "below 10⁻¹²"
    return f"{value:.2f}" if value >= 0.01 else number(value, 1)


def duration(seconds: float) -> str:
    """Return a time in its two largest units."""
    return set_in_print(quantities.duration(seconds))


def instant(nanoseconds: float) -> str:
    """Return a stamp as a date."""
    return datetime.fromtimestamp(nanoseconds * 1e-9, timezone.utc).strftime("%Y-%m-%d %H:%M:%S UTC")


def listed(items: Sequence[str]) -> str:
    """Return items as in a sentence: a, b and c."""
    return " and ".join([", ".join(items[:-1]), items[-1]] if len(items) > 1 else items)


def plain_name(name: str) -> str:
    """Return the name of a kind without underscores."""
    return name.replace("_", " ")


def title_of(name: str) -> str:
    """Return the title of a kind, its name where it is not known."""
    kind = kinds().get(name)
    return kind.title if kind else plain_name(name)


def parameter(effect: Effect, name: str, value: Any) -> str:
    """Return a parameter with its unit."""
    span = effect.spans.get(name)
    label = plain_name(name)
    if span is None or isinstance(value, str):
        return f"{label} {value}"
    if span.unit == "ns":
        return f"{label} {instant(float(value))}"
    if span.unit == "s":
        return f"{label} {duration(float(value))}"
    if not span.unit:
        return f"{label} {float(value):g}"
    return f"{label} {measured(float(value), span.unit)}"


def found_parameters(effect: Effect) -> list[str]:
    """Return the parameters that were looked for, and the channel that another one answers to."""
    several = spectrum_of(effect)
    if several:
        return [several]
    searched = [name for name, span in effect.spans.items() if span.searched]
    values = effect.parameters()
    names = [*searched, *(["source"] if "source" in values else [])]
    return [parameter(effect, name, values[name]) for name in names]


def spectrum_of(effect: Effect) -> str:
    """Return the time constants or thresholds of a memory that has several of them, "" where it has not."""
    memory = effect.memory()
    times: tuple[float, ...] = getattr(memory, "time_constants", ())
    if len(times) == 2:
        return f"time constants {duration(times[0])} and {duration(times[1])}"
    if len(times) > 2:
        return f"{len(times)} time constants from {duration(times[0])} to {duration(times[-1])}"
    plays: tuple[float, ...] = getattr(memory, "thresholds", ())
    if len(plays) > 1:
        return f"{len(plays)} thresholds from {number(plays[0])} to {number(plays[-1])}{SPACE}°C"
    return ""


def all_parameters(effect: Effect) -> list[str]:
    """Return all parameters."""
    return [parameter(effect, name, value) for name, value in effect.parameters().items()]
