"""A calibration that is nothing but memories, and a drive that makes them large."""

from dataclasses import dataclass, field
from math import pi, sin

import numpy as np

from benchmarks.soak.provenance import provenance
from hgma_compensation.calibration.calibration import Calibration, ChannelCalibration, ChannelError
from hgma_compensation.calibration.document import with_id
from hgma_compensation.channels import CHANNELS
from hgma_compensation.drift.inputs import InputScaling
from hgma_compensation.drift.model import CalibratedRange
from hgma_compensation.drift.polynomial import PolynomialDrift
from hgma_compensation.effects.applied import AppliedEffect
from hgma_compensation.effects.registry import make
from hgma_compensation.kalman.settings import FilterSettings
from hgma_compensation.pipeline.live import LiveCompensation
from hgma_compensation.pipeline.live_samples import single_sample
from hgma_compensation.stamps import NANOSECONDS
from hgma_compensation.temperature.features import FeatureSettings
from hgma_compensation.temperature.trend_filter import TrendNoise

Z = CHANNELS[2]
REFERENCE = 9.81
PAST = 300
"""s of history before the first kill."""

EFFECTS: tuple[tuple[str, dict[str, float | str], list[float]], ...] = (
    ("stress_relaxation", {"time_constant": 600.0, "spread": 1.0}, [0.5]),
    (
        "hysteresis",
        {"threshold": 4.0, "spread": 1.0, "bend": 0.0, "plays": 1.0, "before": -273.15, "offset": 0.0},
        [1.0],
    ),
    ("warm_up", {"time_constant": 600.0, "spread": 1.0}, [5.0]),
    ("post_shock_zero_shift", {"threshold": 20.0, "time_constant": 1000.0, "channel": Z}, [0.02, 0.02]),
)


def remembering_calibration() -> Calibration:
    """Return a calibration of one channel whose drift is that of its memories alone."""
    effects = tuple(AppliedEffect(Z, make(name, parameters), np.array(gains)) for name, parameters, gains in EFFECTS)
    nothing = PolynomialDrift(InputScaling(np.zeros(3), np.ones(3)), np.zeros((1, 3), dtype=np.int64), np.zeros(1))
    return with_id(
        Calibration(
            sensor_id="soak",
            features=FeatureSettings(TrendNoise(process=1e-5, measurement=1e-4), delay=20.0, latency=0.1),
            calibrated_range=CalibratedRange(np.array([-11.0, -2.0, -9000.0]), np.array([81.0, 2.0, 9000.0])),
            channels=(ChannelCalibration(Z, nothing, REFERENCE, FilterSettings(), ChannelError(0.1, 0.05)),),
            training=provenance("polynomial", 0),
            effects=effects,
        )
    )


@dataclass
class Truth:
    """A compensation in this process that is never interrupted, and what it and one without a past make of it all.

    drift: m/s² by stamp. forgetful: the same of one that began at the last call of ``forget``.
    """

    calibration: Calibration
    drift: dict[int, float] = field(default_factory=dict)
    forgotten: dict[int, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Begin."""
        self.live, self._forgetful = self._new(), self._new()

    def _new(self) -> LiveCompensation:
        live = LiveCompensation()
        live.install(self.calibration)
        return live

    def forget(self) -> None:
        """Let the one without a past begin anew, as a node without a state file would."""
        self._forgetful = self._new()

    def add_temperature(self, stamp: int, celsius: float) -> None:
        """Take a thermistor sample (ns, °C)."""
        for live in (self.live, self._forgetful):
            live.add_temperature(stamp, celsius)

    def compensate(self, stamp: int, acceleration: float) -> None:
        """Take an acceleration along z (ns, m/s²)."""
        sample = single_sample(stamp, (0.0, 0.0, acceleration, 0.0, 0.0, 0.0))
        for live, drift in ((self.live, self.drift), (self._forgetful, self.forgotten)):
            result = live.compensate(*sample)
            assert result is not None
            drift[stamp] = float(result.compensated.drift[0, 0])


def temperature(seconds: float) -> float:
    """Return the temperature, °C: a steep rise in the past, slow turns from 0 s on."""
    return min(20.0 + 40.0 * (seconds + PAST) / PAST, 60.0) + 6.0 * sin(2.0 * pi * max(seconds, 0.0) / 150.0)


def acceleration(seconds: float) -> float:
    """Return the acceleration along z, m/s²: at rest but for one shock in the past."""
    return REFERENCE + (200.0 if -100.02 < seconds < -99.98 else 0.0)


def past(start: int) -> list[tuple[int, float, float]]:
    """Return stamps (ns), temperatures and accelerations of the time before ``start``, two a second."""
    steps = [k / 2.0 for k in range(-2 * PAST, 0)]
    return [(start + round(s * NANOSECONDS), temperature(s), acceleration(s)) for s in steps]
