"""A calibration made ready to run, away from the stream that it will run in."""

from collections.abc import Mapping
from dataclasses import dataclass

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.effects.effect import Need
from hgma_compensation.pipeline.pipeline import Pipeline
from hgma_compensation.pipeline.remembered import History, Remembered

Histories = Mapping[Need | None, History]
"""What is known of each slow input, None for the thermistor."""


@dataclass(frozen=True)
class Prepared:
    """A pipeline that knows the slow inputs up to the moment at which ``histories`` were taken."""

    pipeline: Pipeline
    histories: Histories

    def follows(self, remembered: Mapping[Need | None, Remembered]) -> bool:
        """Return whether what is remembered now goes on from what this was prepared with."""
        return all(remembered[need].follows(self.histories[need]) for need in self.pipeline.inputs.wanted)

    def catch_up(self, remembered: Mapping[Need | None, Remembered]) -> None:
        """Take the samples that came since."""
        for need in self.pipeline.inputs.wanted:
            for stamp, value in remembered[need].since(self.histories[need]):
                self.pipeline.add(need, stamp, value)


def prepare(calibration: Calibration, histories: Histories) -> Prepared:
    """Return a pipeline that has been given the histories; touches nothing that a stream owns, so any thread may."""
    pipeline = Pipeline(calibration, live=True)
    if (power_on := histories[None].power_on) is not None:
        pipeline.track.updates.assume_power_on(power_on)
    for need in pipeline.inputs.wanted:
        for stamp, value in histories[need].samples:
            pipeline.add(need, stamp, value)
    return Prepared(pipeline, histories)
