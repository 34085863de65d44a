"""Keeps the memories over a restart: parameters of the state file, when it is read and saved, what is said of it."""

import time
from pathlib import Path

from rclpy.clock import Clock, ClockType
from rclpy.node import Node

from hgma_compensation.errors import RefusedError
from hgma_compensation.node import log
from hgma_compensation.node.parameters import STATE_FILE, STATE_MAX_AGE, STATE_PERIOD
from hgma_compensation.pipeline.live import LiveCompensation
from hgma_compensation.pipeline.state_file import read_state, remove_litter
from hgma_compensation.pipeline.state_saver import StateSaver
from hgma_compensation.pipeline.taking_up import DROPPED, SAID, Past

TICK = 1.0
"""s between two looks at what the saver did."""

LAST_SAVE = 5.0
"""s that the end of the node waits for its last save at most."""

RESET_WAIT = 0.2
"""s that a reset waits for the file to be removed, samples waiting with it."""


class StateKeeper:
    """Between a LiveCompensation and its state file; without a file it only tells what has not settled."""

    def __init__(self, node: Node, live: LiveCompensation) -> None:
        """Take the parameters; nothing is read before ``begin``."""
        self._live, self._node = live, node
        path, self._period, self._max_age = (
            node.get_parameter(row.name).value for row in (STATE_FILE, STATE_PERIOD, STATE_MAX_AGE)
        )
        self._path = Path(str(path))
        self._saver = StateSaver(self._path) if path else None
        self._saved_position: object = None
        self._tried_at = time.monotonic()
        self._refusal = self._said_problem = ""
        self._said_past = Past.NONE
        if self._saver is not None:
            # On the steady clock: saving must go on where simulated time stands still.
            node.create_timer(TICK, self._on_tick, clock=Clock(clock_type=ClockType.STEADY_TIME))

    def begin(self) -> None:
        """Read the file, whose memory is taken up if the first sample shows it to be young enough."""
        if self._saver is None:
            return
        remove_litter(self._path)
        self._refusal, self._said_past = "", Past.NONE
        try:
            state = read_state(self._path)
        except RefusedError as refusal:
            self._refusal = str(refusal)
            log.warning(self._node, self._refusal)
            return
        if state is None:
            log.info(self._node, f"{self._path} is not there yet: memories begin without a past")
        else:
            self._live.offer(state, self._max_age)

    def save(self) -> None:
        """Begin to save, where there is something new."""
        position = self._live.position
        if self._saver is None or position is None or position == self._saved_position:
            return
        self._tried_at = time.monotonic()
        if self._saver.save(self._live.snapshot()):
            self._saved_position = position

    def finish(self) -> None:
        """Save for the last time, and wait for it, but not for a disk that hangs."""
        if self._saver is None or not self._saver.wait(LAST_SAVE):
            return
        self.save()
        self._saver.wait(LAST_SAVE)
        self._tell()

    def discard(self) -> str:
        """Remove the file after a reset, and return what to add to the answer."""
        if self._saver is None:
            return ""
        self._saved_position = None
        self._saver.discard()
        if self._saver.wait(RESET_WAIT) and not self._saver.discarding:
            return ", state file removed"
        return f"; but the state file is still there: {self._saver.problem or 'its disk is slow'}"

    def problems(self) -> list[str]:
        """Return what is wrong with the memories or their file, with what to do."""
        unsettled, problems = self._live.unsettled, []
        if unsettled and unsettled[0].seconds:
            problems.append(f"settling, the memory began without a past: {unsettled[0]}{self._advice()}")
        return problems if self._saver is None else problems + self._file_problems(self._saver)

    def values(self) -> list[tuple[str, str]]:
        """Return what became of the past, what has not settled, and figures of the file."""
        settling = "; ".join(str(one) for one in self._live.unsettled)
        values = [("memory", self._live.past.value), ("settling", settling)]
        return values if self._saver is None else values + self._file_values(self._saver)

    def _advice(self) -> str:
        return "" if self._saver is not None else " (set state_file to keep the memory over restarts)"

    def _file_problems(self, saver: StateSaver) -> list[str]:
        problems = [f"the memory is not kept, a restart would lose it: {saver.problem}"] if saver.problem else []
        return problems + ([self._refusal] if self._refusal and not saver.saves else [])

    def _file_values(self, saver: StateSaver) -> list[tuple[str, str]]:
        age = "" if saver.saved_at is None else f"{time.monotonic() - saver.saved_at:.1f}"
        return [
            ("state_file", str(self._path)),
            ("state_saved_seconds_ago", age),
            ("state_bytes", str(saver.size)),
            ("state_saves", str(saver.saves)),
            ("state_save_failures", str(saver.failures)),
            ("state_saves_skipped", str(saver.skipped)),
        ]

    def _on_tick(self) -> None:
        assert self._saver is not None
        self._tell()
        if self._saver.problem and not self._saver.busy:
            self._saved_position = None  # what failed is tried again, also where nothing new has come
        if self._saver.discarding and not self._saver.busy:
            self._saver.discard()
        if time.monotonic() - self._tried_at >= self._period - 0.5 * TICK:
            self.save()

    def _tell(self) -> None:
        """Log what is new: what became of the state from before, and whether saving works."""
        assert self._saver is not None
        past, problem = self._live.past, self._saver.problem
        if past is not self._said_past and past in SAID:
            self._said_past = past
            # Two calls, not one chosen: rclpy allows each place in the code a single severity.
            if past in DROPPED:
                log.warning(self._node, SAID[past])
            else:
                log.info(self._node, SAID[past])
        if problem != self._said_problem and not self._saver.busy:
            self._said_problem = problem
            if problem:
                log.warning(self._node, f"the memory is not kept, the stream goes on: {problem}")
            else:
                log.info(self._node, f"the memory is kept in {self._path} again")
