"""Samples that come in a message each: serialised Imu messages in, compensated ones out."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from rclpy.lifecycle import LifecyclePublisher
from rclpy.serialization import serialize_message
from sensor_msgs.msg import Imu

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.cdr.imu import ImuBatch, batches
from hgma_compensation.cdr.rows import unstacked
from hgma_compensation.cdr.single_imu import SingleImu, SingleImuReader
from hgma_compensation.channels import GROUPS, group_of
from hgma_compensation.messages import absent_groups, imu_values, patch_covariances, patch_imu, stamp_of
from hgma_compensation.node.admission import Admission
from hgma_compensation.node.outputs import States, header_of, publish_all
from hgma_compensation.node.unreadable import read
from hgma_compensation.pipeline.live import LiveCompensation
from hgma_compensation.pipeline.live_samples import single_sample
from hgma_compensation.pipeline.reasons import Note, Skip


class ImuStream:
    """From the topic of raw samples to that of compensated ones, in the order of the input."""

    def __init__(
        self, live: LiveCompensation, admission: Admission, publisher: LifecyclePublisher, states: States
    ) -> None:
        """Compensate with ``live``, publish here."""
        self._live, self._admission, self._publisher, self._states = live, admission, publisher, states
        self._reader = SingleImuReader()
        self._calibration: Calibration | None = None
        self._names: tuple[str, ...] = ()
        self._groups: tuple[str, ...] = ()

    def take(self, raws: Sequence[bytes]) -> int | None:
        """Compensate serialised messages; return the stamp (ns) of the last one, None where it cannot be read."""
        if len(raws) == 1:
            return self._take_single(raws[0])
        newest: int | None = None
        for rows, batch in batches(raws):
            if batch is None:
                newest = self._take_message(raws[rows.start])
            else:
                self._take_batch(raws[rows], batch)
                newest = int(batch.stamps[-1])
        return newest

    def _take_single(self, raw: bytes) -> int | None:
        """Compensate one message, with the results of ``_take_message``; return its stamp as ``take`` does."""
        message = self._reader.read(raw)
        if message is None:
            return self._take_message(raw)
        reason = self._admission.reason_to_skip(message.frame)
        groups = self._covered()[1]
        if reason is None and any(message.absent(group) for group in groups):
            reason = Skip.ABSENT
        if reason is not None:
            self._live.skip_unseen(reason, 1)
            return message.stamp
        if self._states.rest(message.stamp):
            values = self._live.compensate_ordinary(message.stamp, message.values)
            if values is not None:
                self._publish(message, values, None)
                return message.stamp
        answer = self._live.compensate_each(*single_sample(message.stamp, message.values))
        if answer is not None:
            result, compensated = answer[0], answer[0].compensated
            added = compensated.added_variance(0)
            variances = None if added is None else added.tolist()
            self._publish(message, compensated.values[0].tolist(), variances)
            self._states.tell_last(message.stamp, result, lambda _: header_of(raw, message.frame))
        return message.stamp

    def _publish(self, message: SingleImu, values: list[float], variances: list[float] | None) -> None:
        """Publish a message with values (c) of the calibrated channels, and variances added to it."""
        patched, valid = message.patched(self._names, values, variances)
        if not valid:
            self._live.note(Note.COVARIANCE_INVALID)
        publish_all(self._publisher, [patched])

    def _covered(self) -> tuple[tuple[str, ...], tuple[str, ...]]:
        """Return the channels of the calibration in use and the fields they belong to; none without one."""
        calibration = self._live.calibration
        if calibration is not self._calibration:
            names = calibration.names if calibration is not None else ()
            self._calibration, self._names = calibration, tuple(names)
            self._groups = tuple(group for group in GROUPS if any(group_of(name) == group for name in names))
        return self._names, self._groups

    def _take_batch(self, raws: Sequence[bytes], batch: ImuBatch) -> None:
        """Compensate messages of one layout, with the results of ``_take_message`` for one after the other."""
        reason = self._admission.reason_to_skip(batch.frame)
        if reason is not None:
            return self._live.skip_unseen(reason, len(raws))
        kept = self._present(batch)
        stamps, values = batch.stamps, batch.values
        if kept is not None:
            if not len(kept):
                return
            stamps, values = stamps[kept], values[kept]
        answer = self._live.compensate_each(stamps, values)
        if answer is None:
            return
        result, rows = answer
        places = rows if kept is None else kept[rows]
        (names, groups), compensated = self._covered(), result.compensated
        valid = batch.covariances_valid(groups)[places]
        if not valid.all():
            self._live.counts[Note.COVARIANCE_INVALID.value] += int(np.count_nonzero(~valid))
        patched = batch.patched(places, names, compensated.values, compensated.added_variances())
        publish_all(self._publisher, unstacked(patched))
        self._states.tell(batch.stamps[places], result, lambda row: header_of(raws[places[row]], batch.frame))

    def _present(self, batch: ImuBatch) -> NDArray[np.int64] | None:
        """Return the rows that carry the calibrated fields, None for all of them; the others are counted."""
        absent = [batch.absent(group) for group in self._covered()[1]]
        if not any(rows.any() for rows in absent):
            return None
        without = np.logical_or.reduce(absent)
        self._live.skip_unseen(Skip.ABSENT, int(np.count_nonzero(without)))
        return np.flatnonzero(~without)

    def _take_message(self, raw: bytes) -> int | None:
        """Compensate one message of whatever layout; return its stamp (ns), None where it cannot be read."""
        message = read(raw, Imu)
        if message is None:
            self._live.skip_unseen(Skip.UNREADABLE, 1)
            return None
        stamp = stamp_of(message)
        reason = self._admission.reason_to_skip(message.header.frame_id)
        if reason is None and self._live.covers(absent_groups(message)):
            reason = Skip.ABSENT
        if reason is not None:
            self._live.skip_unseen(reason, 1)
            return stamp
        result = self._live.compensate(*single_sample(stamp, imu_values(message)))
        if result is not None:
            names = result.calibration.names
            patch_imu(message, names, result.compensated.values[0].tolist())
            if not patch_covariances(message, names, result.compensated.added_variance(0)):
                self._live.note(Note.COVARIANCE_INVALID)
            publish_all(self._publisher, [serialize_message(message)])
            self._states.tell_last(stamp, result, lambda _: message.header)
        return stamp
