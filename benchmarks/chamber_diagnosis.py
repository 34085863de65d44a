"""Diagnoses the measured chamber recording: learned from the first cooling and the heating, judged on the last cooling.

Prints the error before and after, means over 10 rows as in the table of the data's description, what the memories
were chosen by, and the error of every family of memories that the evidence cannot tell from the chosen one; draws the
picture of the README. Run: make chamber-diagnosis
"""

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from benchmarks.chamber_picture import Raw, draw, draw_before_after
from benchmarks.chamber_table import CHANNELS, ROWS, load, rms
from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.channels import columns_of
from hgma_compensation.diagnosis.augment import augmented
from hgma_compensation.diagnosis.diagnose import diagnose
from hgma_compensation.diagnosis.errors_held_out import HeldOutError, held_out_error
from hgma_compensation.diagnosis.result import ChannelDiagnosis, Diagnosis
from hgma_compensation.diagnosis.spectra import Family, groups_of
from hgma_compensation.measured_data import CHAMBER_SPLIT, VARIABLE, chamber_table
from hgma_compensation.recording.recording import Recording
from hgma_compensation.stamps import NANOSECONDS
from hgma_compensation.training.blocks import group_means, noise_of_means
from hgma_compensation.training.train import TrainingOptions, train

TARGETS = (0.0025, 0.0131, 0.0229)
"""Best of several models tried by hand with sight of the last cooling."""

ALIKE = 5.0
"""Log evidence within which two families are equally good."""


@dataclass(frozen=True)
class Result:
    """The calibration before, the diagnosis, and the recording that it was judged on."""

    calibration: Calibration
    diagnosis: Diagnosis
    cooling: Recording

    def raw(self) -> list[Raw]:
        """Return the errors of the raw readings on the last cooling, means over ROWS rows, for each channel."""
        temperature = np.interp(self.cooling.stamps, self.cooling.temperature.stamps, self.cooling.temperature.values)
        means = group_means(np.arange(len(temperature)) // ROWS, np.column_stack([temperature, self.cooling.values]))
        return [
            Raw(means[:, 0], means[:, 1 + column] - channel.reference)
            for column, channel in zip(columns_of(self.calibration.names), self.calibration.channels, strict=True)
        ]


def run(path: Path, seed: int) -> Result:
    """Train on the first two branches and diagnose them."""
    whole = load(path)
    training = replace(load(path, end=CHAMBER_SPLIT), name="first cooling and heating")
    split = (CHAMBER_SPLIT * NANOSECONDS - whole.start) / NANOSECONDS
    cooling = replace(whole.cut(split, None), name="last cooling")
    calibration = train([training], TrainingOptions(seed=seed))
    return Result(calibration, diagnose([training], calibration, cooling, seed=seed), cooling)


def row_means(error: HeldOutError, reference: float) -> NDArray[np.float64]:
    """Return the errors (n,) of means over ROWS rows of the hold-out."""
    samples = error.samples.values()
    full = samples[: len(samples) // ROWS * ROWS, None] - reference
    return group_means(np.arange(len(full)) // ROWS, full)[:, 0]


def figures(result: Result, channel: ChannelDiagnosis) -> tuple[float, float, float]:
    """Return the RMS before and after, and the noise of such a mean."""
    number = result.calibration.names.index(channel.name)
    references = [c.channels[number].reference for c in (result.calibration, result.diagnosis.calibration)]
    before, after = (row_means(e, r) for e, r in zip((channel.before, channel.after), references, strict=True))
    return float(rms(before[:, None])[0]), float(rms(after[:, None])[0]), noise_of_means(after)


def table(result: Result) -> Table:
    """Return before and after."""
    shown = Table(title="RMS error on the last cooling, m/s², means over 10 rows; chosen inside the first two branches")
    for heading in ("channel", "verdict", "before", "after", "by hand, with sight", "noise"):
        shown.add_column(heading, justify="left" if heading in ("channel", "verdict") else "right")
    for channel, target in zip(result.diagnosis.channels, TARGETS, strict=True):
        before, after, noise = figures(result, channel)
        shown.add_row(
            channel.name, channel.verdict.value, f"{before:.4f}", f"{after:.4f}", f"{target:.4f}", f"{noise:.4f}"
        )
    return shown


def spread(result: Result) -> Table:
    """Return what each family of memories would have given."""
    shown = Table(title="Families of memories: chosen by evidence, among those that know the sweep back")
    for heading in ("channel", "family", "log evidence", "deviation of the sweep back", "error on the last cooling"):
        shown.add_column(heading, justify="left" if heading in ("channel", "family") else "right")
    for channel in result.diagnosis.channels:
        spectra = channel.findings.spectra
        assert spectra is not None
        best = spectra.families[0].posterior.log_evidence
        for family in spectra.families:
            near = family is spectra.chosen or best - family.posterior.log_evidence < ALIKE
            if near or family.deviation < spectra.static:
                mark = " (chosen)" if family is spectra.chosen else ""
                shown.add_row(
                    channel.name,
                    family.title + mark,
                    f"{family.posterior.log_evidence - best:.1f}",
                    f"{family.deviation:.4f}",
                    f"{_error_of(result, channel, family):.4f}",
                )
    return shown


def _error_of(result: Result, channel: ChannelDiagnosis, family: Family) -> float:
    state = channel.findings.state
    problem = state.problem
    alone = replace(
        state.with_effects(family.effects, problem.columns(family.effects)),
        priors=((1.0, groups_of(problem, family.effects)),),
    )
    calibration, _ = augmented(replace(result.calibration, effects=()), channel.name, alone)
    error = held_out_error(result.diagnosis.material, problem.scene.runs, calibration, channel.name)
    number = calibration.names.index(channel.name)
    return float(rms(row_means(error, calibration.channels[number].reference)[:, None])[0])


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the tables and draw the picture."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--picture", type=Path, help="PNG of the error before and after")
    parser.add_argument("--raw-picture", type=Path, help="PNG of the same beside the error of the raw readings")
    chosen = parser.parse_args(arguments)
    path = chamber_table()
    if path is None:
        print(f"the measured data are not there: set {VARIABLE}", file=sys.stderr)
        return 2
    console = Console(width=130)
    result = run(path, chosen.seed)
    console.print(table(result))
    console.print(spread(result))
    if chosen.picture is not None:
        draw(result.diagnosis.channels, chosen.picture)
    if chosen.raw_picture is not None:
        draw_before_after(result.raw(), result.diagnosis.channels, chosen.raw_picture)
    return 0


if __name__ == "__main__":
    assert len(CHANNELS) == len(TARGETS)
    sys.exit(main())
