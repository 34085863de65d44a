"""Cross-axis sensitivity: the channel answers to acceleration along another axis."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from hgma_compensation.channels import group_of
from hgma_compensation.effects.conditions import Conditions
from hgma_compensation.effects.effect import Array, Effect, Need, Survey, column_of
from hgma_compensation.effects.registry import register
from hgma_compensation.effects.requirements import require_channel


@register
@dataclass(frozen=True)
class CrossAxis(Effect):
    """k·a of the source channel (cross-axis sensitivity of IEEE Std 1293)."""

    source: str

    name = "cross_axis"
    title = "cross-axis sensitivity"
    needs = (Need.OTHER_AXIS,)
    identified_by = "acceleration along the other axis that varies by itself"
    gain_unit = "/(m/s^2)"

    def check(self) -> None:
        """Refuse what is not a channel."""
        require_channel("source", self.source)

    @property
    def count(self) -> int:
        """One column."""
        return 1

    def columns(self, at: Conditions, state: Array) -> Array:
        """Return the acceleration of the source, m/s²; 0 where that axis has none."""
        acceleration = at.acceleration[:, column_of(self.source)]
        return np.where(np.isnan(acceleration), 0.0, acceleration)[:, None]

    @classmethod
    def candidates(cls, survey: Survey) -> Iterator["CrossAxis"]:
        """Yield the effect of each other axis."""
        for source in survey.others:
            if group_of(source) == "linear_acceleration":
                yield cls(source)
