"""What an autopilot's cubic leaves of the drift in a recording, beside what the full calibration leaves."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from hgma_compensation import topics
from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.channels import columns_of
from hgma_compensation.drift.inputs import Array
from hgma_compensation.errors import RefusedError
from hgma_compensation.evaluation.evaluate import Evaluation
from hgma_compensation.evaluation.long_evaluation import LongEvaluation, Part
from hgma_compensation.progress import Advance
from hgma_compensation.recording.bag_reader import open_bag
from hgma_compensation.recording.bag_topics import BagTopics
from hgma_compensation.recording.offline_run import OfflineRun
from hgma_compensation.recording.reading import no_samples
from hgma_compensation.recording.recording import Extent
from hgma_compensation.recording.streamed import EVER, survey
from hgma_compensation.stamps import Stamps
from hgma_compensation.training.reference import Reference

Offsets = Callable[[Stamps, Array], Array]
"""Takes stamps (n,), ns, and temperatures (n,), °C, that follow on those before; returns what is subtracted (n, c)."""


@dataclass(frozen=True)
class RecordingLoss:
    """RMS errors of one channel over means of 5 s, in its unit; noise_floor: of such a mean by white noise alone."""

    channel: str
    raw: float
    cubic: float
    full: float
    noise_floor: float


def loss_on(
    path: Path,
    calibration: Calibration,
    offsets: Offsets,
    reference: Reference,
    *,
    names: topics.TopicNames,
    span: tuple[float | None, float | None] = (None, None),
    progress: Advance | None = None,
) -> tuple[RecordingLoss, ...]:
    """Return the errors of each channel of a bag, read once, in memory that does not depend on its length.

    span: s from the start of the recording that count; what comes before is run through for its history, which a
    robot has too, and a memory without a past would be judged by its beginning. The autopilot's thermometer is taken to
    be as good as the pipeline's trend of the recorded one. Raises RefusedError where the bag lacks what the calibration
    needs.
    """
    path = Path(path)
    extent, first, last = None, *EVER
    if span != (None, None) and (whole := survey(path, names)) is not None:
        extent = Extent(whole.name, whole.start, whole.duration)
        first, last = extent.span(*span)
    full, cubic = (LongEvaluation(calibration, reference) for _ in range(2))
    with open_bag(path) as bag:
        found = BagTopics(bag, path, names)
        run = OfflineRun(bag, path, found, calibration, found.read)
        for batch, made in run.windows():
            if made is not None and len(made.samples):
                times = made.messages.stamps[made.samples]
                raw = made.messages.values[made.samples][:, columns_of(calibration.names)]
                temperature = made.result.features[:, 0].copy()
                corrected = raw - offsets(times, temperature)
                rows = (times >= first) & (times < last)
                for gathered, values in ((full, made.result.values), (cubic, corrected)) if rows.any() else ():
                    gathered.add(Part(times[rows], raw[rows], values[rows], temperature[rows]))
            if progress is not None:
                progress(len(batch))
    if not run.samples:
        raise no_samples(path, found)
    run.check()
    if not full.samples and extent is not None:
        raise extent.nothing_left(*span)
    if not full.samples:
        raise RefusedError(f"{path.name} has no sample that is finite in all channels that the calibration needs")
    return _losses(cubic.evaluation(), full.evaluation())


def _losses(cubic: Evaluation, full: Evaluation) -> tuple[RecordingLoss, ...]:
    return tuple(
        RecordingLoss(
            channel=of_full.name,
            raw=of_full.raw.rms_error,
            cubic=of_cubic.compensated.rms_error,
            full=of_full.compensated.rms_error,
            noise_floor=of_full.noise_floor,
        )
        for of_cubic, of_full in zip(cubic.channels, full.channels, strict=True)
    )
