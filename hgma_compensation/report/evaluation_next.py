"""What to do after an evaluation."""

from dataclasses import dataclass
from pathlib import Path
from shlex import quote

from hgma_compensation.evaluation.evaluate import ChannelEvaluation
from hgma_compensation.report.cards import command
from hgma_compensation.report.evaluation_sentences import kind
from hgma_compensation.report.run_record import RunSummary
from hgma_compensation.report.trained_on import TrainedOn

MUCH = 0.1
"""Share of samples outside of the calibrated range from which on that is the first thing to mend."""


@dataclass(frozen=True)
class Evaluated:
    """What was evaluated, in the words of the user."""

    bag: Path
    calibration_file: Path
    reference: str

    @property
    def name(self) -> str:
        """Name of the recording, also where it was called by "."."""
        return self.bag.resolve().name


def next_step(channel: ChannelEvaluation, summary: RunSummary, about: Evaluated, known: TrainedOn) -> list[str]:
    """Return a sentence and the command to type."""
    bag, file = quote(str(about.bag)), quote(str(about.calibration_file))
    if kind(channel) == "bad":
        return [
            "Next, check that it is the calibration of this sensor and that the units and topics are right: ",
            command(f"hgma inspect {file}"),
        ]
    if kind(channel) == "good" and known.certain:
        return [
            "Next, judge it on a recording that it was not trained on: ",
            command(f"hgma evaluate ANOTHER_BAG --calibration {file}"),
        ]
    if kind(channel) == "good":
        return ["Next, run it: ", command(f"hgma node --ros-args -p calibration_file:={file}")]
    if summary.outside > MUCH * summary.samples:
        return [
            "Next, train over the temperatures and rates that this recording has: ",
            command(f"hgma train ANOTHER_BAG {bag} -o wider.json"),
        ]
    said = "Next, let the effect that the model lacks be named and added (with more recordings of the sensor, if any): "
    return [said, command(f"hgma diagnose {bag} --calibration {file} -o diagnosis")]
