"""What an autopilot's cubic leaves of the drift in a recording, beside what the full calibration leaves."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

from hgma_compensation import topics
from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.drift.inputs import Array
from hgma_compensation.evaluation.evaluate import Evaluation
from hgma_compensation.evaluation.evaluate_bag import judged_windows
from hgma_compensation.evaluation.long_evaluation import LongEvaluation
from hgma_compensation.progress import Advance
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
    full, cubic = (LongEvaluation(calibration, reference) for _ in range(2))
    for window in judged_windows(path, calibration, names=names, span=span, remembered=True, progress=progress):
        part = window.part
        corrected = part.raw - offsets(part.stamps, part.temperature)  # also where it does not count: the history
        full.add(window.counted(part))
        cubic.add(window.counted(replace(part, compensated=corrected)))
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
