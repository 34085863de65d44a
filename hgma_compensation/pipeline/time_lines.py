"""Keeps the slow inputs apart from those of the time line before, where stamps begin anew at different moments.

When a bag loops, the thermistor's first sample of the new round may come before the accelerometer's last one of the
old, or after its first one of the new. Each acceleration is compensated with the inputs of its own round.
"""

from collections.abc import Callable

from hgma_compensation.effects.effect import Need
from hgma_compensation.pipeline.inputs import Inputs
from hgma_compensation.temperature.track import PLAUSIBLE_CELSIUS, Sample, judge
from hgma_compensation.time_jumps import TIME_JUMP, StepBack


class TimeLines:
    """The inputs of the accelerometer's time line, and of those after it that slow inputs are on already.

    A stream that is live has one such time line at the most; a recording that is read whole may have many.
    """

    def __init__(self, make: Callable[[], Inputs], *, live: bool) -> None:
        """Take what makes inputs without history."""
        self._make, self._live = make, live
        self.reset()

    def reset(self) -> None:
        """Forget all samples."""
        self.current = self._make()
        self._following: list[Inputs] = []
        self._ahead: dict[Need | None, int] = {}

    def add(self, need: Need | None, stamp: int, value: float, accelerometer: int | None) -> Sample:
        """Take a sample of an input (ns, °C or V); accelerometer: its newest stamp, None before the first."""
        inputs = self._of(need)
        if not self._begins_anew(inputs, need, stamp, value) or self._has_arrived(stamp, accelerometer):
            return inputs.add(need, stamp, value)
        self._ahead[need] = self._next(need)
        if self._ahead[need] > len(self._following):
            self._following.append(self._make())
        self._of(need).add(need, stamp, value)
        return Sample.RESTARTED

    def _of(self, need: Need | None) -> Inputs:
        ahead = self._ahead.get(need, 0)
        return self._following[ahead - 1] if ahead else self.current

    def _next(self, need: Need | None) -> int:
        return 1 if self._live else self._ahead.get(need, 0) + 1

    def _begins_anew(self, inputs: Inputs, need: Need | None, stamp: int, value: float) -> bool:
        last = inputs.updates(need).last
        # Nearly every sample is later than the one before, and needs no judgement here.
        if last is None or stamp > last - TIME_JUMP:
            return False
        return judge(stamp, value, PLAUSIBLE_CELSIUS, inputs.updates(need)) is Sample.RESTARTED

    def _has_arrived(self, stamp: int, accelerometer: int | None) -> bool:
        """Return whether the accelerometer is on the time line that begins with a stamp already."""
        return self._live and (accelerometer is None or accelerometer <= stamp + TIME_JUMP)

    def sets_back(self, need: Need | None, stamp: int) -> bool:
        """Return whether a sample of an input at a stamp (ns) would move those before it to a corrected clock."""
        updates = self._of(need).updates(need)
        return updates.last is not None and stamp <= updates.last and updates.step_back(stamp) is StepBack.CORRECTED

    @property
    def single(self) -> bool:
        """Whether no slow input is on a later time line than the accelerometer."""
        return not self._following

    def is_ahead(self, need: Need | None) -> bool:
        """Return whether an input is on a later time line than the accelerometer."""
        return self._ahead.get(need, 0) > 0

    def turn(self) -> None:
        """Go on to the next time line: the accelerometer's stamps have begun anew."""
        self.current = self._following.pop(0) if self._following else self._make()
        self._ahead = {need: ahead - 1 for need, ahead in self._ahead.items() if ahead > 1}

    def succeed(self, before: "TimeLines") -> None:
        """Stand where other time lines stand, having been given the newest samples of each input only."""
        if before._following:
            self._following, self.current = [self.current], self._make()
            self._ahead = dict.fromkeys(before._ahead, 1)

    def follow(self, stamp: int) -> None:
        """Go on to the next time line where that of a live thermistor has caught up with the accelerometer (ns)."""
        if self._live and self._following:
            newest = self._following[0].temperature.last
            if newest is not None and stamp <= newest:
                self.turn()
