"""Acceptance limits: a file of them, and which of them a sensor breaks."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

from hgma_compensation import schema_check
from hgma_compensation.bounded_files import read_text
from hgma_compensation.channels import group_of, unit_of
from hgma_compensation.errors import RefusedError
from hgma_compensation.fleet.figures import BY_NAME, FIGURES, Figures, Worse
from hgma_compensation.plain_values import check_plain
from hgma_compensation.plain_yaml import load_plain

LARGEST_FILE = 1 << 20


@dataclass(frozen=True)
class Broken:
    """A limit that a channel does not keep; value: None where the figure is not defined, which keeps no limit."""

    channel: str
    figure: str
    value: float | None
    limit: float

    def __str__(self) -> str:
        """Return it in words."""
        figure = BY_NAME[self.figure]
        unit = figure.unit(unit_of(self.channel)).replace("^2", "²")
        if self.value is None:
            return f"{self.channel}: {figure.title} is not defined, the recording is too short for it"
        sign = "<" if figure.worse is Worse.DOWN else ">"
        value = abs(self.value) if figure.worse is Worse.AWAY else self.value
        return f"{self.channel}: {figure.title} {value:.4g} {sign} {self.limit:.4g} {unit}".rstrip()


class Limits:
    """Limits by channel or group, then figure."""

    def __init__(self, sections: Mapping[str, Mapping[str, float]] | None = None) -> None:
        """Take limits that follow the schema; none at all are allowed."""
        self.sections = {name: dict(limits) for name, limits in (sections or {}).items()}

    def __bool__(self) -> bool:
        """Return whether there is any."""
        return any(self.sections.values())

    def of(self, channel: str) -> dict[str, float]:
        """Return the limits of a channel, in the order of FIGURES."""
        found = {**self.sections.get(group_of(channel), {}), **self.sections.get(channel, {})}
        return {figure.name: found[figure.name] for figure in FIGURES if figure.name in found}

    def broken(self, channels: Mapping[str, Figures]) -> tuple[Broken, ...]:
        """Return the limits that a sensor breaks."""
        return tuple(
            Broken(channel, name, figures[name], limit)
            for channel, figures in channels.items()
            for name, limit in self.of(channel).items()
            if not keeps(name, figures[name], limit)
        )

    def judges(self, channels: Mapping[str, Figures]) -> bool:
        """Return whether any figure of a sensor has a limit."""
        return any(self.of(channel) for channel in channels)


def keeps(name: str, value: float | None, limit: float) -> bool:
    """Return whether a figure keeps its limit."""
    if value is None:
        return False
    figure = BY_NAME[name]
    return figure.badness(value) <= figure.badness(limit)


def read_limits(path: Path) -> Limits:
    """Return the limits in a YAML file; raises RefusedError naming the field that is wrong."""
    try:
        document = load_plain(read_text(path, LARGEST_FILE))
        check_plain(document)
        schema_check.check(document, schema_check.load_schema(__package__, "acceptance.schema.json"))
        sections = {name: limits for name, limits in cast(dict[str, Any], document).items() if name != "acceptance"}
        limits = Limits(sections)
        if not limits:
            raise RefusedError("sets no limit: give at least one, or leave --limits out")
    except RefusedError as refusal:
        text = str(refusal)
        raise RefusedError(text if text.startswith(f"{path} ") else f"limits {path}: {text}") from None
    return limits
