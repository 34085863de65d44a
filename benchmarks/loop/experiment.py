"""An experiment with one sensor: four oven programmes, and what happens during them."""

from dataclasses import dataclass

from hgma_compensation.simulation.description import Heating, Powered, Step, VoltageStep
from hgma_compensation.simulation.motion_description import Orientation, Shock, Vibration

NEEDS = {
    "warm_up": "power_cycles",
    "thermal_gradient": "heating",
    "supply_voltage": "supply",
    "scale_factor_temperature": "levels",
    "quadratic_nonlinearity": "levels",
    "vibration_rectification": "vibration",
    "post_shock_zero_shift": "shocks",
    "cross_axis": "lateral",
}
"""What must happen during the recordings for an effect to show."""

HARMLESS = ("power_cycles", "heating", "supply", "lateral")
"""What may happen, or be logged, without putting real acceleration on the channel that is judged."""

NOMINAL = 5.0
"""V of the supply."""

Window = tuple[float, float]


@dataclass(frozen=True)
class Experiment:
    """Times are s from the start of the first recording; accelerations m/s².

    parts: what happens, of NEEDS. orientations: specific force (x, y, z) held, only x and z of the still sensor but
    for "lateral" and "levels". voltage_steps: V. heating: of the second thermometer. shrink: of all durations.
    """

    steps: tuple[Step, ...]
    windows: tuple[Window, ...]
    powered: tuple[Powered, ...]
    parts: frozenset[str]
    shrink: float = 1.0
    heating: tuple[Heating, ...] = ()
    voltage_steps: tuple[VoltageStep, ...] = ()
    orientations: tuple[Orientation, ...] = ()
    vibrations: tuple[Vibration, ...] = ()
    shocks: tuple[Shock, ...] = ()

    @property
    def duration(self) -> float:
        """Time from the start of the first recording to the end of the last, s."""
        return self.windows[-1][1]
