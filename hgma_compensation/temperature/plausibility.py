"""Tells the jumps and the standstill of a broken thermometer from temperature."""

from enum import Enum
from math import inf, sqrt

from hgma_compensation.temperature.trend_filter import TrendNoise

FASTEST = 2.0
"""°C/s: the air of a thermal-shock chamber changes like this, no sensor's package does."""

LEAST_JUMP = 3.0
"""°C: a smaller change is no jump, however fast."""

AGREEING = 3
"""Samples after a jump that agree with each other, from which on the new temperature is believed."""

STUCK_SAMPLES, STUCK_SECONDS = 20, 10.0
"""Equal samples in a row, and their time, that a thermometer with noise above its resolution never sends: two of them
are equal with a probability below 0.3."""


class Verdict(Enum):
    """What a sample looks like after those before it. MOVED: the first one to be believed after a jump."""

    FINE = "fine"
    JUMPED = "jumped"
    MOVED = "moved"
    STUCK = "stuck"


class Plausibility:
    """Judges finite samples in the order of their stamps."""

    def __init__(self, noise: TrendNoise) -> None:
        """Take the noise of the thermometer."""
        self._sigma = sqrt(noise.measurement)
        self._least = max(LEAST_JUMP, 10.0 * self._sigma)
        self._resolution = inf
        self.reset()

    def reset(self) -> None:
        """Forget all samples; the resolution that they showed, the least difference of two, stays known."""
        self._used: tuple[int, float] | None = None
        self._jumped: tuple[int, float] | None = None
        self._agreeing = 0
        self._unchanged_since: int | None = None
        self._equal = 0

    def unchanged(self, stamp: int) -> float:
        """Return for how long (s), at a stamp in ns, the samples have had exactly the same value."""
        return 0.0 if self._unchanged_since is None else max(0.0, (stamp - self._unchanged_since) * 1e-9)

    def judge(self, stamp: int, celsius: float) -> Verdict:
        """Say what a sample (ns, °C) looks like; it counts as used unless it JUMPED."""
        verdict = Verdict.FINE
        if self._used is not None and not self._follows(self._used, stamp, celsius):
            if not self._believed(stamp, celsius):
                return Verdict.JUMPED
            verdict = Verdict.MOVED
        self._jumped, self._agreeing = None, 0
        self._compare(stamp, celsius)
        self._used = (stamp, celsius)
        return Verdict.STUCK if self._is_stuck(stamp) else verdict

    def _follows(self, before: tuple[int, float], stamp: int, celsius: float) -> bool:
        return abs(celsius - before[1]) <= self._least + FASTEST * max(0.0, (stamp - before[0]) * 1e-9)

    def _believed(self, stamp: int, celsius: float) -> bool:
        """Take a sample that jumped; return whether enough of them agree."""
        agrees = self._jumped is not None and self._follows(self._jumped, stamp, celsius)
        self._agreeing = self._agreeing + 1 if agrees else 1
        self._jumped = (stamp, celsius)
        return self._agreeing >= AGREEING

    def _compare(self, stamp: int, celsius: float) -> None:
        difference = inf if self._used is None else abs(celsius - self._used[1])
        if difference == 0.0:
            self._equal += 1
            return
        self._resolution = min(self._resolution, difference)
        self._equal, self._unchanged_since = 0, stamp

    def _is_stuck(self, stamp: int) -> bool:
        # Where the noise does not reach over one step of the resolution, equal samples are the rule.
        dithered = self._resolution <= self._sigma
        return dithered and self._equal >= STUCK_SAMPLES and self.unchanged(stamp) >= STUCK_SECONDS
