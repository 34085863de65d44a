"""What effects of real acceleration along the channel itself have in common."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TypeVar

from hgma_compensation.effects.conditions import Conditions
from hgma_compensation.effects.effect import Array, Effect, Survey, column_of
from hgma_compensation.effects.requirements import require_channel

Kind = TypeVar("Kind", bound="InputDriven")


@dataclass(frozen=True)
class InputDriven(Effect):
    """An effect on a channel of the acceleration along it."""

    channel: str

    per_sample = True
    input_driven = True

    def check(self) -> None:
        """Refuse what is not a channel."""
        require_channel("channel", self.channel)

    def acceleration(self, at: Conditions) -> Array:
        """Return the channel's acceleration (n,), m/s²."""
        return at.acceleration[:, column_of(self.channel)]

    @classmethod
    def candidates(cls: type[Kind], survey: Survey) -> Iterator[Kind]:
        """Yield the effect on the surveyed channel; nothing where it stood still."""
        if survey.inputs:
            yield cls(survey.channel)
