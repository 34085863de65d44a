"""Gives back the velocity that the filter withheld before the gate opened.

The first, weak part of a shock passes while the gate is still closed, and the smoothed output holds it
back; so does it the slow rise before many shocks, which is far below the noise of a sample. What was
withheld over LOOK_BACK samples is added again in small instalments afterwards, so that the integral of
the output over a shock is that of the input, and its peak is left alone.
"""

from collections import deque

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.kalman.quiet import sum_in_order

LOOK_BACK = 1024
"""Samples before an opening whose integral is made good."""

INSTALMENTS = 192
"""Parts in which it is: as many samples as the gate needs to close at the least."""

CALM = 3.0
"""Standard deviations: instalments are paid on samples within this of the level, never near a peak."""


class ImpulseDebt:
    """Withheld velocity, in the channel's unit times s."""

    def __init__(self) -> None:
        """Owe nothing."""
        self.reset()

    def reset(self) -> None:
        """Forget what is owed."""
        self._withheld: deque[float] = deque(maxlen=LOOK_BACK)
        self._earlier = np.empty(0)
        self._owed = self._instalment = 0.0

    @property
    def owes(self) -> bool:
        """Whether there is anything to pay."""
        return self._owed != 0.0

    def withhold(self, impulse: float) -> None:
        """Note what one sample's output lacks: (input - output) · dt."""
        self._withheld.append(impulse)

    def withhold_all(self, impulses: NDArray[np.float64]) -> None:
        """Note what outputs (n,) lack."""
        if len(impulses) < LOOK_BACK:
            self._withheld.extend(impulses.tolist())
            return
        # All that was noted is older. Not made numbers of one by one: seldom is any of them called in.
        self._earlier = np.array(impulses[-LOOK_BACK:])
        self._withheld.clear()

    def call_in(self) -> None:
        """The gate has opened: owe what the samples before it lack."""
        withheld = [*self._earlier.tolist(), *self._withheld][-LOOK_BACK:]
        if withheld:
            self._owed += sum_in_order(withheld)
        self._instalment = abs(self._owed) / INSTALMENTS
        self._withheld.clear()
        self._earlier = np.empty(0)

    def pay(self, dt: float, normalised: float) -> float:
        """Return what to add to the output of a sample of length dt (s), whose innovation is ``normalised``."""
        if self._owed == 0.0 or not -CALM <= normalised <= CALM:
            return 0.0
        impulse = min(max(self._owed, -self._instalment), self._instalment)
        # The last instalment is what is left, so the debt ends at exactly nothing.
        self._owed -= impulse
        return impulse / dt

    def pay_all(self, dt: float | NDArray[np.float64], normalised: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return what to add to the outputs (n,) of samples of length dt, (n,) or one for all: as ``pay`` does."""
        payments = np.zeros(len(normalised))
        for k in np.flatnonzero(np.abs(normalised) <= CALM).tolist():
            if not self.owes:
                break
            payments[k] = self.pay(dt if isinstance(dt, float) else float(dt[k]), float(normalised[k]))
        return payments
