"""An immutable calibration of one sensor."""

from dataclasses import dataclass, field
from typing import Any

from hgma_compensation.drift.model import CalibratedRange, DriftModel
from hgma_compensation.effects.applied import AppliedEffect
from hgma_compensation.effects.stage import EffectStage
from hgma_compensation.kalman.settings import FilterSettings
from hgma_compensation.temperature.features import FeatureSettings

LONGEST_SENSOR_ID = 200
"""Characters, as calibration.schema.json allows."""


@dataclass(frozen=True)
class ChannelError:
    """What training knows of its own error, RMS in the channel's unit over means of the block length.

    fit: on the data it was fitted to. cross_validated: on cycles left out of the fit, None where the
    method has none. noise: of such a mean, from its second differences.
    """

    fit: float
    noise: float
    cross_validated: float | None = None

    @property
    def unseen(self) -> float:
        """Best guess of the error on data that was not fitted."""
        return self.fit if self.cross_validated is None else self.cross_validated


@dataclass(frozen=True)
class ChannelCalibration:
    """One channel: its drift model, the still value that the compensated output keeps, its filter."""

    name: str
    drift: DriftModel
    reference: float
    filter: FilterSettings
    error: ChannelError


@dataclass(frozen=True)
class Calibration:
    """All that the pipeline needs, and where it came from.

    training: how and on what it was trained, as it stands in the file. calibration_id: derived from
    the content; two files with the same id compensate alike. effects: what the drift models cannot carry, on
    calibrated channels.
    """

    sensor_id: str
    features: FeatureSettings
    calibrated_range: CalibratedRange
    channels: tuple[ChannelCalibration, ...]
    training: dict[str, Any] = field(hash=False)
    calibration_id: str = ""
    effects: tuple[AppliedEffect, ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the channels, in the order of every array that the pipeline returns."""
        return tuple(channel.name for channel in self.channels)

    @property
    def channels_read(self) -> tuple[str, ...]:
        """Names of all channels that compensation reads: the calibrated ones, then others that effects answer to."""
        return self.names + self.stage().other_channels

    def stage(self) -> EffectStage:
        """Return the effects together, without a past."""
        return EffectStage(self.effects, self.names, [channel.reference for channel in self.channels])
