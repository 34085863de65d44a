"""Supply voltage: a ratiometric bridge reads its supply."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from hgma_compensation.effects.conditions import Conditions
from hgma_compensation.effects.effect import Array, Effect, Need, Span, Survey, normalised
from hgma_compensation.effects.registry import register

_NOMINAL = Span("V", 0.5, 60.0, searched=False)


@register
@dataclass(frozen=True)
class SupplyVoltage(Effect):
    """(V − V0)·(a + b·x), V0 the nominal voltage, x = (T − 25 °C)/35 °C (EFFECTS catalogue form)."""

    nominal: float

    name = "supply_voltage"
    title = "dependence on the supply voltage"
    slow = True
    spans: ClassVar[dict[str, Span]] = {"nominal": _NOMINAL}
    needs = (Need.SUPPLY_VOLTAGE,)
    identified_by = "a logged supply voltage with steps of 1 % or more"
    gain_unit = "/V"

    @property
    def count(self) -> int:
        """The deviation, alone and times x."""
        return 2

    def columns(self, at: Conditions, state: Array) -> Array:
        """Return V − V0, V, and the same times x; 0 where the voltage is unknown."""
        deviation = np.where(np.isnan(at.supply_voltage), 0.0, at.supply_voltage - self.nominal)
        return np.column_stack([deviation, deviation * normalised(at.temperature)])

    @classmethod
    def candidates(cls, survey: Survey) -> Iterator["SupplyVoltage"]:
        """Yield the effect about the recorded voltage, nothing where that is none."""
        if _NOMINAL.lower <= survey.voltage <= _NOMINAL.upper:
            yield cls(survey.voltage)
