"""Prints the paper's Table 3 on a simulated oven test, and beside it what the figures mean.

Trained on the first cycles of the scenario, judged on its last one, which no stage has seen and whose ramp
rate no training cycle has. The noise figures are read on a record of the same sensor at rest. docs/PAPER.md
explains the rows. Run: make paper-table
"""

import argparse
import json
import sys
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from rich.console import Console

from benchmarks.paper_judge import floors, judge_drift, judge_noise, shocks
from benchmarks.paper_ladder import ALONE, BASELINES, DRIFT_MODEL, LADDER, ORIGINAL, Experiment, Progress, Rows
from benchmarks.paper_oven import OvenTest
from benchmarks.paper_report import ROWS, error_report, noise_report, paper_report, shock_report, table_3
from benchmarks.spread import spread
from hgma_compensation.errors import RefusedError
from hgma_compensation.recording.csv_table import STANDARD_GRAVITY
from hgma_compensation.training.genetic import GeneticSettings

WIDTH = 170


def measure(experiment: Experiment, seeds: Sequence[int], console: Console) -> dict[str, Any]:
    """Return the figures of all rows, medians and spread over seeds of the simulation and of the training."""
    runs = []
    for seed in seeds:
        with console.status("simulating") as status:
            runs.append(one_seed(experiment, seed, status.update))
    return {"scenario": experiment.scenario.name, "seeds": list(seeds), **spread(runs)}


def one_seed(experiment: Experiment, seed: int, progress: Progress) -> dict[str, Any]:
    """Return the figures of all rows of one simulated sensor."""
    progress(f"seed {seed}: simulating")
    test, made = experiment.run(seed, lambda name: progress(f"seed {seed}: {name}"))
    floor = {k: v / STANDARD_GRAVITY for k, v in asdict(floors(test, made.calibrations[DRIFT_MODEL])).items()}
    rows: dict[str, Any] = {}
    for name in ROWS:
        progress(f"seed {seed}: judging {name}")
        rows[name] = judge_row(test, made, name)
        rows[name]["drift"]["over_floor"] = rows[name]["drift"]["rms_error_g"] / floor["with_thermistor"]
    for name in LADDER + ALONE:
        rows[name]["ratio"] = {key: table_3(rows[ORIGINAL])[key] / value for key, value in table_3(rows[name]).items()}
    return {"floor_g": floor, "rows": rows}


def judge_row(test: OvenTest, made: Rows, name: str) -> dict[str, Any]:
    """Return the figures of a row: drift; noise but for baselines; shocks where something could change them."""
    calibration = made.calibrations.get(name)
    figures: dict[str, Any] = {"drift": judge_drift(test, calibration)}
    if name not in BASELINES:
        figures |= judge_noise(test, calibration, made.stages.get(name))
        figures["shock"] = {} if calibration is None else shocks(calibration, test.white_noise)
    return figures


def argument_parser(description: str) -> argparse.ArgumentParser:
    """Return a parser of what an Experiment needs."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenario", type=Path, default=Experiment.scenario, help="oven test to simulate")
    parser.add_argument("--generations", type=int, default=GeneticSettings.generations, help="of the genetic search")
    parser.add_argument("--still-hours", type=float, default=Experiment.still_hours, help="of the record at rest")
    return parser


def experiment_of(given: argparse.Namespace) -> Experiment:
    """Return the experiment that the parsed arguments describe."""
    return Experiment(given.scenario, GeneticSettings(generations=given.generations), given.still_hours)


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the tables; with --json also write the figures."""
    parser = argument_parser(__doc__ or "")
    parser.add_argument("--seeds", type=int, default=1, help="seeds 1 to this, of simulation and training")
    parser.add_argument("--json", type=Path, help="file for the figures")
    given = parser.parse_args(arguments)
    if given.seeds < 1:
        parser.error("--seeds: at least 1")
    try:
        figures = measure(experiment_of(given), range(1, given.seeds + 1), Console(stderr=True))
    except RefusedError as refusal:
        print(refusal, file=sys.stderr)
        return 2
    for report in (paper_report, error_report, noise_report, shock_report):
        Console(width=WIDTH).print(report(figures))
    if given.json:
        given.json.write_text(json.dumps(figures, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
