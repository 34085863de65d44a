"""Measures everything against its rivals and prints one table: ``make bench``; BENCH_ARGUMENTS="messages" some of it.

Exit code 1 where the median of a row misses its target, or a group could not be measured.
"""

import argparse
import json
import os
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import asdict
from importlib import import_module
from pathlib import Path
from typing import Any

from rich.console import Console

from benchmarks.bench import document, machine
from benchmarks.bench.calibrations import Calibrations
from benchmarks.bench.given import Given
from benchmarks.bench.row import Result, Row
from benchmarks.bench.samples import SEED
from benchmarks.bench.table import terminal_table
from hgma_compensation.demo.processes import private_ros_environment
from hgma_compensation.files import write_atomically

GROUPS = ("messages", "blocks", "offline", "memory", "filtering", "training", "start", "options")
"""Modules of this package, each with ``measure``; loaded only where they are asked for."""

ROOT = Path(__file__).parents[2]
BAGS = ROOT / "build" / "bench"
DOCUMENT = ROOT / "docs" / "PERFORMANCE.md"
REPETITIONS, LEAST = 5, 3
WIDTH = 200


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the groups that are named, or all."""
    parser = argument_parser()
    chosen = parser.parse_args(arguments)
    if unknown := set(chosen.names) - set(GROUPS):
        parser.error(f"there is no group {', '.join(sorted(unknown))}: choose from {', '.join(GROUPS)}")
    if chosen.repetitions < LEAST:
        parser.error(f"--repetitions: at least {LEAST}")
    if chosen.write_docs and chosen.names:
        parser.error("--write-docs: the document holds the table of all groups, of one run")
    described = machine.describe() | {"seed": str(SEED), "repetitions": str(chosen.repetitions)}
    os.environ.update(private_ros_environment())  # for this process and all that it starts
    results, failed = run(chosen.names or GROUPS, chosen.repetitions)
    rows = [row for result in results.values() for row in result.rows]
    Console(width=WIDTH).print(terminal_table(rows))
    if chosen.json:
        write_atomically(chosen.json, (json.dumps(figures(results, described), indent=1) + "\n").encode())
    if chosen.write_docs and not failed:
        document.update(DOCUMENT, rows, described)
    missed = [f"{row.group}: {row.name}" for row in rows if row.verdict == "missed"]
    print(f"missed: {'; '.join(missed)}" if missed else "no target missed")
    if failed:
        print(f"not measured: {', '.join(failed)}")
    return 1 if missed or failed else 0


def argument_parser() -> argparse.ArgumentParser:
    """Return the parser of the command line."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.bench", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="GROUP", help=f"which of them: {', '.join(GROUPS)}")
    parser.add_argument("--repetitions", type=int, default=REPETITIONS, help=f"by turns, at least {LEAST}")
    parser.add_argument("--json", type=Path, metavar="FILE", help="also write all figures to FILE")
    parser.add_argument("--write-docs", action="store_true", help="write table and machine into docs/PERFORMANCE.md")
    return parser


def run(names: Sequence[str], repetitions: int) -> tuple[dict[str, Result], list[str]]:
    """Return the results of groups, and the names of those that could not be measured; says how far it is."""
    results, failed = {}, []
    BAGS.mkdir(parents=True, exist_ok=True)
    # Beside the bags, so that both lie on the same disk.
    with tempfile.TemporaryDirectory(dir=BAGS) as folder:
        scratch = Path(folder)
        given = Given(repetitions, BAGS, scratch, Calibrations(scratch, BAGS), say)
        for name in names:
            try:
                results[name] = import_module(f"benchmarks.bench.{name}").measure(given)
            except RuntimeError as error:  # the other groups' minutes are not to be lost with it
                say(f"{name}: {error}")
                failed.append(name)
    return results, failed


def say(text: str) -> None:
    """Show on standard error how far the run is."""
    print(text, file=sys.stderr, flush=True)


def figures(results: dict[str, Result], described: dict[str, str]) -> dict[str, Any]:
    """Return all figures for the JSON: each row with those of every repetition, and the details."""
    return {
        "machine": described,
        "rows": [_row(row) for result in results.values() for row in result.rows],
        "details": {name: result.details for name, result in results.items() if result.details},
    }


def _row(row: Row) -> dict[str, Any]:
    return asdict(row) | {"ratios": row.ratios, "ratio": row.ratio, "verdict": row.verdict}


if __name__ == "__main__":
    sys.exit(main())
