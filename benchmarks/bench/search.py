"""Search for the highest rate at which a trial succeeds."""

from collections.abc import Callable
from dataclasses import dataclass
from math import sqrt


@dataclass(frozen=True)
class Search:
    """step: factor from one rate to the next while none has failed, or none succeeded. finest: factor at which it ends.

    attempts: trials at a rate before it counts as failed; a machine that does something else for a moment fails one.
    lowest, highest: Hz, between which is searched.
    """

    step: float = 1.5
    finest: float = 1.05
    attempts: int = 2
    lowest: float = 20.0
    highest: float = 200_000.0

    def highest_rate(self, trial: Callable[[float], bool], first: float) -> float:
        """Return the highest rate found at which a trial succeeded; begins at ``first``.

        Raises RuntimeError where none succeeds down to the lowest.
        """
        good, bad = self._bracket(trial, first)
        while bad is not None and bad / good > self.finest * (1.0 + 1e-9):
            middle = sqrt(good * bad)
            if self._succeeds(trial, middle):
                good = middle
            else:
                bad = middle
        return good

    def _bracket(self, trial: Callable[[float], bool], first: float) -> tuple[float, float | None]:
        """Return a rate that succeeded and the next one, which failed; None where all up to the highest succeeded."""
        if self._succeeds(trial, first):
            good = first
            while (rate := good * self.step) <= self.highest:
                if not self._succeeds(trial, rate):
                    return good, rate
                good = rate
            return good, None
        bad = first
        while (rate := bad / self.step) >= self.lowest:
            if self._succeeds(trial, rate):
                return rate, bad
            bad = rate
        raise RuntimeError(f"no trial succeeded at {bad:g} Hz or above")

    def _succeeds(self, trial: Callable[[float], bool], rate: float) -> bool:
        return any(trial(rate) for _ in range(self.attempts))


FIRST = Search(finest=1.1)
"""Where nothing is known of the rate; the repetitions after it go on in finer steps."""

AGAIN = Search(step=1.05)
"""From the rate of the repetition before."""
