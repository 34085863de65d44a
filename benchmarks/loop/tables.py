"""The tables of a run, for the terminal and as markdown."""

from collections.abc import Sequence
from dataclasses import dataclass

from rich.table import Table

from benchmarks.loop.cases import EFFECTS, GENERATORS, GROUPS
from benchmarks.loop.score import EFFECT_FREE, Outcome, Ratios, Summary, confusion, false_alarm_rate, summarise


@dataclass(frozen=True)
class Sheet:
    """A title, headings (k) and rows of k cells."""

    title: str
    headings: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]

    def rich(self) -> Table:
        """Return the table for a terminal."""
        table = Table(title=self.title)
        for number, heading in enumerate(self.headings):
            table.add_column(heading, justify="right" if number else "left")
        for row in self.rows:
            table.add_row(*row)
        return table

    def markdown(self) -> str:
        """Return the table as markdown."""
        lines = (self.headings, ("---", *["---:"] * (len(self.headings) - 1)), *self.rows)
        return f"## {self.title}\n\n" + "".join(f"| {' | '.join(line)} |\n" for line in lines)


def sheets(outcomes: Sequence[Outcome]) -> tuple[Sheet, ...]:
    """Return the tables of a run: counts, errors, who is taken for whom."""
    order = sorted(outcomes, key=lambda o: (o.group, o.generator, o.index))
    parts = [
        (group, generator, [o for o in order if (o.group, o.generator) == (group, generator)])
        for group in GROUPS
        for generator in GENERATORS
    ]
    summaries = [(group, generator, summarise(part)) for group, generator, part in parts if part]
    matrices = [_confusion(group, [o for o in order if o.group == group]) for group in GROUPS]
    return _counts(summaries), _errors(summaries), *(sheet for sheet in matrices if sheet.rows)


def headline(outcomes: Sequence[Outcome]) -> str:
    """Return the run in one line."""
    rate = false_alarm_rate(outcomes)
    alarms = "" if rate is None else f", false alarms in {100.0 * rate:.0f} % of the effect-free ones"
    failed = sum(bool(o.failure) for o in outcomes)
    return f"{len(outcomes)} cases, {failed} without a result{alarms}."


def _counts(summaries: Sequence[tuple[str, str, Summary]]) -> Sheet:
    headings = ("group", "sensor", "cases", "failed", "named any", "right name", "right class", "exact", "unexplained")
    rows = []
    for group, generator, s in summaries:
        answerable = group in ("single", "pairs")
        right = [str(n) if answerable else "" for n in (s.right_name, s.right_class, s.exact)]
        rest = "" if group in EFFECT_FREE else str(s.unexplained)
        rows.append((group, generator, str(s.cases), str(s.failures), str(s.named), *right, rest))
    return Sheet("What was named", headings, tuple(rows))


def _errors(summaries: Sequence[tuple[str, str, Summary]]) -> Sheet:
    headings = ("group", "sensor", "after/before", "90 %", "after/oracle", "90 %", "after/best", "90 %", "s", "90 %")
    rows = []
    for group, generator, s in summaries:
        ratios = (s.after_over_before, s.after_over_oracle, s.after_over_best, s.seconds)
        rows.append((group, generator, *(cell for ratio in ratios for cell in _cells(ratio))))
    return Sheet("Error on the held-out recording, median and 90th percentile", headings, tuple(rows))


def _confusion(group: str, outcomes: Sequence[Outcome]) -> Sheet:
    """Return one row for each truth: what was said first, most often first."""
    table = confusion(outcomes)
    known = {name: number for number, name in enumerate(EFFECTS)}
    rows = []
    for truth in sorted(table, key=lambda name: (known.get(name, len(known)), name)):
        said = ", ".join(f"{name} {count}" for name, count in table[truth].most_common())
        rows.append((truth, said))
    return Sheet(f"Truth and what was named first: {group}", ("truth", "named first"), tuple(rows))


def _cells(ratio: Ratios) -> tuple[str, str]:
    median, ninety = (("-" if value is None else f"{value:.2f}") for value in (ratio.median, ratio.ninety))
    return median, ninety
