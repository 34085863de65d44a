"""How long the effects of a calibration still show that their memory began without a past."""

from dataclasses import dataclass

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.temperature.track import TAKEN, Sample


@dataclass
class MemorySpan:
    """What the thermistor has gone through since the memories began: stamps in ns, temperatures in °C."""

    began: int | None = None
    newest: int | None = None
    lowest: float = 0.0
    highest: float = 0.0

    def add(self, stamp: int, celsius: float, outcome: Sample) -> None:
        """Take a thermistor sample (ns, °C) of which the pipeline said what became of it."""
        if outcome not in TAKEN:
            return
        if self.began is None or self.newest is None or outcome is Sample.RESTARTED:
            self.began, self.lowest, self.highest = stamp, celsius, celsius
        elif outcome is Sample.SET_BACK:
            self.began -= self.newest - stamp
        self.newest, self.lowest, self.highest = stamp, min(self.lowest, celsius), max(self.highest, celsius)

    @property
    def seconds(self) -> float:
        """Return the time since the memories began, s."""
        return 0.0 if self.began is None or self.newest is None else (self.newest - self.began) * 1e-9


@dataclass(frozen=True)
class Unsettled:
    """An effect that has not settled: seconds that it still needs, and °C of span that the temperature must cover."""

    effect: str
    channel: str
    seconds: float
    span: float

    def __str__(self) -> str:
        """Return it in words."""
        needs = [f"for {self.seconds:.0f} s more"] if self.seconds else []
        needs += [f"until the temperature has covered {self.span:.2g} °C more"] if self.span else []
        return f"{self.effect} of {self.channel} {' and '.join(needs)}"


def unsettled(calibration: Calibration, span: MemorySpan) -> list[Unsettled]:
    """Return the effects that have not settled, the longest first; none before the first thermistor sample."""
    if span.began is None:
        return []
    found = [
        Unsettled(
            applied.effect.name,
            applied.channel,
            max(0.0, applied.effect.settling - span.seconds),
            max(0.0, applied.effect.settling_span - (span.highest - span.lowest)),
        )
        for applied in calibration.effects
    ]
    return sorted((one for one in found if one.seconds or one.span), key=lambda one: (-one.seconds, -one.span))
