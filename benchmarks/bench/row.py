"""A row of the table: what was measured of ours and of the rival, by turns, and their ratio."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from statistics import median

Pair = tuple[tuple[float, ...], tuple[float, ...]]
"""Figures of ours and of the rival, one of each for every repetition."""


@dataclass(frozen=True)
class Target:
    """What the median of the ratios must be: at least the limit, or at most."""

    limit: float
    at_least: bool = False

    def met(self, ratio: float) -> bool:
        """Return whether a ratio is on the right side."""
        return ratio >= self.limit if self.at_least else ratio <= self.limit

    def __str__(self) -> str:
        """Return it as the table shows it."""
        return f"{'≥' if self.at_least else '≤'} {self.limit:g}"


@dataclass(frozen=True)
class Row:
    """Figures of a row, one of each side for every repetition, in the unit.

    target: None where the row only informs. note: what has to be known beside the figures.
    """

    group: str
    name: str
    unit: str
    rival_name: str
    ours: tuple[float, ...]
    rival: tuple[float, ...]
    target: Target | None = None
    note: str = ""

    @property
    def ratios(self) -> tuple[float, ...]:
        """Return ours over the rival's of the same repetition."""
        return tuple(ours / rival for ours, rival in zip(self.ours, self.rival, strict=True))

    @property
    def ratio(self) -> float:
        """Return the median of the ratios."""
        return median(self.ratios)

    @property
    def verdict(self) -> str:
        """Return met or missed, "" without a target."""
        if self.target is None:
            return ""
        return "met" if self.target.met(self.ratio) else "missed"


@dataclass(frozen=True)
class Result:
    """Rows of a group, and what was seen beside them, for the JSON only."""

    rows: tuple[Row, ...]
    details: dict[str, object] = field(default_factory=dict)


def alternate(repetitions: int, ours: Callable[[], float], rival: Callable[[], float]) -> Pair:
    """Return the figures of both sides, measured by turns, so that what the machine does meanwhile hits both."""
    return transposed([(ours(), rival()) for _ in range(repetitions)])


def transposed(turns: Sequence[tuple[float, float]]) -> Pair:
    """Return the figures of either side out of both of each repetition."""
    return tuple(ours for ours, _ in turns), tuple(rival for _, rival in turns)
