"""Numbers as people read them, with their unit: the one rule of terminal and reports.

Files and JSON keep SI numbers as they are, with units as in ``m/s^2``; this is for what is shown.
"""

from itertools import pairwise
from math import floor, isfinite, log10

STANDARD_GRAVITY = 9.80665
"""m/s²."""

UNKNOWN = "-"
"""Stands for what is not known; a table that shows it says why below."""

DIGITS = 4
"""Significant digits of what was measured."""

_PLAIN = range(-4, 9)
"""Decimal exponents that are written out; other numbers are written as 1.234e-05."""

_HIGH_G = 1000.0
"""m/s²: from here on g stands beside, which people of high-g sensors think in."""

_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_STEPS = (("d", 86400), ("h", 3600), ("min", 60), ("s", 1))


def shown_unit(unit: str) -> str:
    """Return a unit with its powers raised and its products dotted: "m/s^2" becomes "m/s²"."""
    first, *others = unit.replace("*", "·").split("^")
    shown = first
    for other in others:
        length = next((i for i, character in enumerate(other) if not (character.isdigit() or character == "-")), None)
        power = other if length is None else other[:length]
        shown += power.translate(_SUPERSCRIPTS) + other[len(power) :]
    return shown


def number(value: float | None, digits: int = DIGITS) -> str:
    """Return a measured number with its significant digits, trailing zeros kept, in groups of three from 10 000 on."""
    if value is None or not isfinite(value):
        return UNKNOWN
    if value == 0.0:
        return "0"
    rounded = float(f"{value:.{digits - 1}e}")
    exponent = floor(log10(abs(rounded)))
    if exponent not in _PLAIN:
        return f"{rounded:.{digits - 1}e}"
    return _grouped(f"{rounded:.{max(digits - 1 - exponent, 0)}f}")


def setting(value: float) -> str:
    """Return a number that somebody has chosen as it was given, without trailing zeros: 60, 0.5, 9.80665."""
    return _grouped(f"{value:.7g}")


def count(value: int) -> str:
    """Return a whole number in groups of three from 10 000 on."""
    return _grouped(str(value))


def counted(how_many: int, what: str) -> str:
    """Return how many of something there are: 1 gap, 12 000 gaps."""
    return f"{count(how_many)} {what}{'' if how_many == 1 else 's'}"


def quantity(value: float | None, unit: str, digits: int = DIGITS, g_from: float = _HIGH_G) -> str:
    """Return a measured number with its unit; from ``g_from`` (m/s²) on with g beside: 17 770 m/s² (1812 g)."""
    shown = number(value, digits)
    if shown == UNKNOWN or value is None:
        return UNKNOWN
    text = f"{shown} {shown_unit(unit)}".rstrip()
    if unit in ("m/s^2", "m/s²") and abs(value) >= g_from:
        return f"{text} ({number(value / STANDARD_GRAVITY, digits)} g)"
    return text


def chosen(value: float, unit: str) -> str:
    """Return a number that somebody has chosen with its unit."""
    return f"{setting(value)} {shown_unit(unit)}".rstrip()


def duration(seconds: float) -> str:
    """Return a time in its two largest units: 2 h 13 min, 3 d 4 h, 1 min 30 s; below a minute 9.68 s."""
    if not isfinite(seconds):
        return UNKNOWN
    sign, seconds = ("-" if seconds < 0.0 else ""), abs(seconds)
    if round(seconds, 1) < 60.0:
        shown = f"{seconds:.3g}" if seconds < 1.0 else f"{round(seconds, 2):.4g}"
        return f"{sign}{shown} s"
    for (name, size), (next_name, next_size) in pairwise(_STEPS):
        whole = round(seconds / next_size)  # rounded in the smaller unit first: 59.9 min are 1 h
        if whole * next_size >= size:
            large, small = divmod(whole, size // next_size)
            return f"{sign}{large} {name}" + (f" {small} {next_name}" if small else "")
    return f"{sign}{seconds:.3g} s"


def _grouped(digits: str) -> str:
    """Return the text of a number with its whole part in groups of three, where that has more than four digits."""
    sign, rest = ("-", digits[1:]) if digits.startswith("-") else ("", digits)
    whole, point, fraction = rest.partition(".")
    if len(whole) > 4 and whole.isdecimal():
        whole = f"{int(whole):,}".replace(",", " ")
    return sign + whole + point + fraction
