"""Simulates sensors with undisclosed effects, trains, diagnoses, and prints what was found and what it was worth.

The headings: "right name" counts cases whose first named effect is there; after/before and after/oracle compare
errors on the held-out recording, against the truth, over means of 5 s: before and after the diagnosis, and of a
training on the same recordings without the effect. "best" is what a perfect drift model would leave.
"""

import argparse
import json
import sys
from collections.abc import Sequence
from dataclasses import asdict
from math import isfinite, nan
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from benchmarks.loop.cases import GENERATORS, GROUPS, items
from benchmarks.loop.score import Outcome, first_said
from benchmarks.loop.tables import headline, sheets
from benchmarks.loop.worker import Task, run_all

WIDTH = 160

COUNTS = {"none": 5, "single": 2, "pairs": 1, "unknown": 2, "removed": 1, "thermistor_0.05": 1}
"""Cases of each item, where the user does not say: enough for the shares that are asked of each group."""


def tasks_of(given: argparse.Namespace) -> list[Task]:
    """Return the cases of a run: so many of each item of each group and generator."""
    generators = tuple(GENERATORS) if given.generator == "both" else (given.generator,)
    return [
        Task(group, index, given.seed, generator, given.generations)
        for group in given.groups
        for generator in generators
        for index in range((given.count or COUNTS[group]) * len(items(group, generator)))
    ]


def read_log(log: Path) -> list[Outcome]:
    """Return the outcomes of a log; none where there is no such file."""
    if not log.exists():
        return []
    lines = [json.loads(line) for line in log.read_text(encoding="utf-8").splitlines()]
    return [outcome_of(line) for line in lines]


def outcome_of(line: dict[str, Any]) -> Outcome:
    """Return the outcome of a line of a log."""
    fields: Any = {key: nan if value is None else _tupled(value) for key, value in line.items()}
    return Outcome(**dict(fields))


def _tupled(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value


def collect(tasks: Sequence[Task], jobs: int, log: Path, console: Console, *, resume: bool) -> list[Outcome]:
    """Run the tasks, write each outcome as a line of JSON, and show how far it is.

    resume: those that the log has already are taken from it.
    """
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    known = {(o.group, o.generator, o.index, o.seed): o for o in (read_log(log) if resume else []) if not o.failure}
    wanted = [(task, (task.group, task.generator, task.index, task.seed)) for task in tasks]
    outcomes = [known[key] for _, key in wanted if key in known]
    tasks = [task for task, key in wanted if key not in known]
    with log.open("a" if resume else "w", encoding="utf-8") as file, Progress(*columns, console=console) as progress:
        bar = progress.add_task("diagnosing", total=len(tasks))
        for outcome in run_all(tasks, jobs):
            outcomes.append(outcome)
            file.write(json.dumps(line_of(outcome), ensure_ascii=False) + "\n")
            file.flush()
            truth = "+".join(outcome.truth) or "none"
            progress.console.print(
                f"{outcome.group} {outcome.generator} {outcome.index} {truth}: {first_said(outcome)}"
            )
            progress.advance(bar)
    return outcomes


def line_of(outcome: Outcome) -> dict[str, Any]:
    """Return the fields of an outcome; numbers that there are not are null."""
    fields = asdict(outcome).items()
    return {key: None if isinstance(value, float) and not isfinite(value) else value for key, value in fields}


def argument_parser() -> argparse.ArgumentParser:
    """Return the parser of the command line."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.loop", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--groups", nargs="+", choices=GROUPS, default=list(GROUPS), metavar="GROUP")
    parser.add_argument("--count", type=int, help=f"cases of each item of a group, else {COUNTS}")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2, help="cases at a time")
    parser.add_argument("--generator", choices=(*GENERATORS, "both"), default="both")
    parser.add_argument("--generations", type=int, help="of the genetic search, the method's own number if not given")
    parser.add_argument("--output", type=Path, default=Path("docs/LOOP.md"), help="markdown file for the tables")
    parser.add_argument("--resume", action="store_true", help="go on with the log of an interrupted run")
    parser.add_argument("--log", type=Path, help="JSON lines, one a case; beside the output if not given")
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the benchmark and write its tables."""
    parser = argument_parser()
    given = parser.parse_args(arguments)
    if (given.count is not None and given.count < 1) or given.jobs < 1:
        parser.error("--count and --jobs: at least 1")
    log = given.log or given.output.with_suffix(".jsonl")
    for path in (given.output, log):
        path.parent.mkdir(parents=True, exist_ok=True)
    outcomes = collect(tasks_of(given), given.jobs, log, Console(stderr=True), resume=given.resume)
    tables = sheets(outcomes)
    console = Console(width=WIDTH)
    for table in tables:
        console.print(table.rich())
    console.print(headline(outcomes))
    text = "\n".join(["# The loop on simulated sensors\n", headline(outcomes) + "\n", *(t.markdown() for t in tables)])
    given.output.write_text(text, encoding="utf-8")
    return 1 if any(outcome.failure for outcome in outcomes) else 0


if __name__ == "__main__":
    sys.exit(main())
