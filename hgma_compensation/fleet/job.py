"""The calibration of one sensor of a fleet: what a worker does, on this machine or another."""

from __future__ import annotations

import contextlib
import json
from pathlib import Path

from hgma_compensation.calibration.document import write_calibration
from hgma_compensation.errors import RefusedError
from hgma_compensation.evaluation.evaluate_bag import evaluate_bag
from hgma_compensation.files import write_atomically
from hgma_compensation.fleet.figures import figures_of
from hgma_compensation.fleet.options import Job
from hgma_compensation.fleet.sensors import recordings_of
from hgma_compensation.fleet.split import split
from hgma_compensation.fleet.status import (
    CALIBRATION,
    EVALUATION,
    STATUS,
    Judged,
    Status,
    digest,
    finished,
    inputs_of,
    write_status,
)
from hgma_compensation.training.linear_algebra import one_thread
from hgma_compensation.training.reference import Reference
from hgma_compensation.training.train import train


@one_thread()
def run_job(job: Job) -> Status:
    """Return what became of a sensor, which is in its folder too; nothing that is wrong with it is raised.

    Where the folder holds what the same inputs gave before, nothing is computed.
    """
    folder = job.output / job.sensor
    try:
        return _calibrated(job, folder)
    except RefusedError as refusal:
        reason = str(refusal)
    except MemoryError:
        reason = "out of memory: calibrate with fewer --workers, or on a machine that has more"
    except Exception as error:  # one sensor must not end the others, whatever it is that it sets off
        reason = str(RefusedError(f"unexpected {type(error).__name__}: {error}: please report it with its recording"))
    return failed(job, reason)


def failed(job: Job, reason: str) -> Status:
    """Return, and keep in the sensor's folder, that it could not be calibrated."""
    folder = job.output / job.sensor
    status = Status(job.sensor, reason=_relative(reason, job))
    with contextlib.suppress(RefusedError, OSError):  # a folder that cannot be written to may be the very reason
        folder.mkdir(exist_ok=True)
        _clear(folder)
        write_status(status, folder)
    return status


def _calibrated(job: Job, folder: Path) -> Status:
    place, options = job.source / job.sensor, job.options
    recordings = recordings_of(place)
    inputs = inputs_of(options, recordings, place)
    before = finished(folder, job.sensor, inputs)
    if before is not None:
        return before
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise RefusedError(f"{folder} cannot be made ({error.strerror}): choose another output") from None
    _clear(folder)
    parts = split(recordings, options.holdout, options.names)
    calibration = train(parts.training, options.of(job.sensor))
    reference = Reference(tuple(channel.reference for channel in calibration.channels))
    # Of a part, with the memory of what went before: the beginning of a stream says nothing of the sensor.
    judged_from = (parts.limit, None)
    evaluation = evaluate_bag(
        parts.judged, calibration, reference, names=options.names, span=judged_from, remembered=True
    )
    write_calibration(calibration, folder / CALIBRATION)
    content = json.dumps(evaluation.as_json(), indent=1, allow_nan=False) + "\n"
    write_atomically(folder / EVALUATION, content.encode())
    judged = Judged(
        calibration_id=calibration.calibration_id,
        trained_on=tuple(recording.name for recording in parts.training),
        judged_on=parts.judged.name,
        limit=parts.limit,
        reference=str(reference),
    )
    status = Status(
        sensor=job.sensor,
        judged=judged,
        channels={channel.name: figures_of(channel) for channel in evaluation.channels},
        inputs=inputs,
        outputs={name: digest(folder / name) for name in (CALIBRATION, EVALUATION)},
    )
    write_status(status, folder)
    return status


def _clear(folder: Path) -> None:
    """Remove what other inputs gave, the status first: what is without one counts for nothing."""
    for name in (STATUS, CALIBRATION, EVALUATION):
        try:
            (folder / name).unlink(missing_ok=True)
        except OSError as error:
            raise RefusedError(f"{folder / name} cannot be replaced ({error.strerror}): remove it") from None


def _relative(reason: str, job: Job) -> str:
    """Return a reason with paths from the fleet's folders on, so that it is the same wherever these lie."""
    for folder in (job.source, job.output):
        reason = reason.replace(f"{folder}/", "")
    return reason
