"""Which messages of the accelerometer are looked at, decided by what is known before their samples."""

from collections.abc import Callable

from hgma_compensation.pipeline.live import LiveCompensation
from hgma_compensation.pipeline.reasons import Skip


class Admission:
    """Follows lifecycle and frame. publishing: whether samples get an output."""

    def __init__(self, live: LiveCompensation, wanted_frame: str, begin: Callable[[], None]) -> None:
        """Admit messages of one frame, "" for any; ``begin`` is called where another one begins."""
        self._live, self._wanted, self._begin = live, wanted_frame, begin
        self._frame: str | None = None
        self.publishing = False

    def reason_to_skip(self, frame: str) -> Skip | None:
        """Return why messages of a frame are not even looked at, None where they are."""
        if not self.publishing:
            return Skip.NOT_ACTIVE
        if frame != self._frame:
            if self._wanted not in ("", frame):
                return Skip.OTHER_FRAME
            self._frame = frame
            self._live.begin_frame(frame)
            self._begin()
        return None
