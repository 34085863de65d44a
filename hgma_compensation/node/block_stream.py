"""Samples that come in blocks: serialised AccelBlock messages in, compensated ones out."""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from rclpy.lifecycle import LifecyclePublisher
from rclpy.serialization import serialize_message

from hgma_compensation import topics
from hgma_compensation.cdr.block import BlockLayout, BlockView
from hgma_compensation.cdr.header import read_stamp
from hgma_compensation.channels import AXES, CHANNELS, GROUPS
from hgma_compensation.errors import RefusedError
from hgma_compensation.messages import block_samples, check_block, patch_block, stamp_of, widen_block
from hgma_compensation.node.admission import Admission
from hgma_compensation.node.outputs import States, header_of, publish_all
from hgma_compensation.node.unreadable import read
from hgma_compensation.pipeline.live import LiveCompensation
from hgma_compensation.pipeline.live_result import LiveResult
from hgma_compensation.pipeline.ordinary_block import offsets_of
from hgma_compensation.pipeline.reasons import Skip
from hgma_msgs.msg import AccelBlock


class BlockStream:
    """From the topic of raw blocks to that of compensated ones."""

    def __init__(
        self, live: LiveCompensation, admission: Admission, publisher: LifecyclePublisher, states: States
    ) -> None:
        """Compensate with ``live``, publish here."""
        self._live, self._admission, self._publisher, self._states = live, admission, publisher, states
        self._layout: BlockLayout | None = None

    def take(self, raws: Sequence[bytes]) -> int | None:
        """Compensate serialised messages; return the stamp (ns) of the last one, None where it cannot be read."""
        newest: int | None = None
        for raw in raws:
            newest = self._take_whole(raw)
            if newest is None:
                view = BlockView.of(raw)
                newest = self._take_message(raw) if view is None else self._take_view(raw, view)
        return newest

    def _take_whole(self, raw: bytes) -> int | None:
        """Compensate a block laid out like the one before as a whole; None where it must be looked at.

        The result is that of ``_take_view``.
        """
        layout = self._layout
        if layout is None or not layout.holds(raw) or self._admission.reason_to_skip(layout.frame) is not None:
            return None
        stamp, offsets = read_stamp(raw), offsets_of(layout.count, layout.sample_interval)
        patched = bytearray(raw)
        if not self._live.compensate_block(stamp, offsets, layout.axes(raw), layout.axes(patched)):
            return None
        publish_all(self._publisher, [patched])
        last, end = stamp + offsets.last, self._live.block_end
        if end is not None and not (end.ordinary and self._states.rest(last)):
            self._states.tell_last(last, end.result, lambda _: header_of(raw, layout.frame))
        return stamp

    def _take_view(self, raw: bytes, view: BlockView) -> int:
        """Compensate a block of a recognised layout, with the result of ``_take_message``."""
        count = len(view.x)
        reason = self._admission.reason_to_skip(view.frame)
        if reason is not None:
            self._live.skip_unseen(reason, count)
            return view.stamp
        try:
            check_block(view, topics.RAW_BLOCK)
        except RefusedError:
            self._live.skip_unseen(Skip.MALFORMED_BLOCK, max(count, 1))
            return view.stamp
        if not count:
            return view.stamp
        if self._layout is None or not self._layout.holds(raw):
            self._layout = BlockLayout(view)
        stamps = view.stamp + offsets_of(count, view.sample_interval).stamps
        result = self._live.compensate(stamps, _widened(view))
        if result is not None:
            publish_all(self._publisher, [view.patched(_axes(result))])
            self._states.tell_last(int(stamps[-1]), result, lambda _: header_of(raw, view.frame))
        return view.stamp

    def _take_message(self, raw: bytes) -> int | None:
        """Compensate one block of whatever layout; return its stamp (ns), None where it cannot be read."""
        message = read(raw, AccelBlock)
        if message is None:
            self._live.skip_unseen(Skip.UNREADABLE, 1)
            return None
        stamp = stamp_of(message)
        reason = self._admission.reason_to_skip(message.header.frame_id)
        if reason is not None:
            self._live.skip_unseen(reason, len(message.x))
            return stamp
        try:
            stamps, values = block_samples(message, topics.RAW_BLOCK)
        except RefusedError:
            self._live.skip_unseen(Skip.MALFORMED_BLOCK, max(len(message.x), 1))
            return stamp
        result = self._live.compensate(stamps, widen_block(values)) if len(stamps) else None
        if result is not None:
            patch_block(message, result.calibration.names, result.compensated.values)
            publish_all(self._publisher, [serialize_message(message)])
            self._states.tell_last(int(stamps[-1]), result, lambda _: message.header)
        return stamp


@lru_cache(maxsize=1)
def _room(count: int) -> NDArray[np.float64]:
    """Return memory for the accelerations of a block (count, 6), of which those of the angular rate are 0.

    Column by column, as they are read. The same for all blocks of a length: what is new must be cleared and mapped.
    """
    return np.zeros((len(CHANNELS), count)).T


def _widened(view: BlockView) -> NDArray[np.float64]:
    """Return the accelerations of a block as columns of CHANNELS (n, 6); they are gone with the next block."""
    wide = _room(len(view.x))
    for column, axis in enumerate(AXES):
        wide[:, column] = getattr(view, axis)
    return wide


def _axes(result: LiveResult) -> dict[str, NDArray[np.float32]]:
    """Return the axes of a block that the calibration covers, as ``patch_block`` overwrites them."""
    values = result.compensated.values
    return {
        name[-1]: values[:, column].astype(np.float32)
        for column, name in enumerate(result.calibration.names)
        if name.startswith(GROUPS[0])
    }
