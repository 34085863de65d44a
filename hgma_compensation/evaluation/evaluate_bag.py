"""Error of a bag before and after compensation, in memory that does not depend on its length."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from hgma_compensation import topics
from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.channels import columns_of
from hgma_compensation.errors import RefusedError
from hgma_compensation.evaluation.evaluate import Evaluation
from hgma_compensation.evaluation.long_evaluation import LongEvaluation, Part
from hgma_compensation.kept_memory import return_memory
from hgma_compensation.pipeline.compensated import Compensated
from hgma_compensation.progress import Advance
from hgma_compensation.recording.bag_reader import open_bag
from hgma_compensation.recording.bag_topics import BagTopics
from hgma_compensation.recording.offline_run import OfflineRun
from hgma_compensation.recording.reading import no_samples
from hgma_compensation.recording.recording import Extent
from hgma_compensation.recording.streamed import survey
from hgma_compensation.training.reference import Reference


def evaluate_bag(
    path: Path,
    calibration: Calibration,
    reference: Reference,
    *,
    names: topics.TopicNames,
    span: tuple[float | None, float | None] = (None, None),
    remembered: bool = False,
    progress: Advance | None = None,
    observe: Callable[[Part, Compensated], None] | None = None,
) -> Evaluation:
    """Return the errors of a bag, compensated as ``hgma compensate`` does.

    span: s from the start of the recording that count, from the first to before the second. remembered: what lies
    outside of it is compensated too, as by a node that ran all the time, but does not count; else it is not read.
    observe: called with the samples as they go by, counted or not, and what the pipeline made of them. Raises
    RefusedError where the bag lacks what the calibration needs, or no sample is left.
    """
    return_memory()
    gathered = LongEvaluation(calibration, reference)
    for window in judged_windows(path, calibration, names=names, span=span, remembered=remembered, progress=progress):
        gathered.add(window.counted(window.part))
        if observe is not None:
            observe(window.part, window.result)
    return gathered.evaluation()


@dataclass(frozen=True)
class JudgedWindow:
    """Samples as they go by, counted or not, and what the pipeline made of them. span: stamps that count, ns."""

    part: Part
    result: Compensated
    span: tuple[int, int] | None

    def counted(self, part: Part) -> Part:
        """Return those samples of this window, or of another output for it, that count."""
        return part if self.span is None else part.within(self.span)


def judged_windows(
    path: Path,
    calibration: Calibration,
    *,
    names: topics.TopicNames,
    span: tuple[float | None, float | None],
    remembered: bool,
    progress: Advance | None,
) -> Iterator[JudgedWindow]:
    """Yield the samples of a bag, compensated, in their order; arguments and refusals as of ``evaluate_bag``."""
    path, extent, stamps = Path(path), None, None
    if span != (None, None):
        whole = survey(path, names)
        if whole is not None:
            extent = Extent(whole.name, whole.start, whole.duration)
            stamps = extent.span(*span)
    counted = 0
    with open_bag(path) as bag:
        found = BagTopics(bag, path, names)
        run = OfflineRun(bag, path, found, calibration, found.read, None if remembered else stamps)
        for batch, made in run.windows():
            if made is not None and len(made.samples):
                raw = made.messages.values[made.samples][:, columns_of(calibration.names)]
                result = made.result
                part = Part(made.messages.stamps[made.samples], raw, result.values, result.features[:, 0].copy())
                window = JudgedWindow(part, result, stamps if remembered else None)
                counted += len(window.counted(part).stamps)
                yield window
            if progress is not None:
                progress(len(batch))
    if not run.samples:
        raise no_samples(path, found) if extent is None else extent.nothing_left(*span)
    run.check()
    if not counted and remembered and extent is not None:
        raise extent.nothing_left(*span)
    if not counted:
        raise RefusedError(
            f"{path.name} has no sample that is finite in all of {', '.join(calibration.names)}, which the calibration "
            "needs: look for NaN in what the driver publishes, or train with the --channels that the sensor delivers"
        )
