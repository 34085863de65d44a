"""What a programme must have, one rule each with its reason, and what each effect asks beyond that."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum

from hgma_compensation.effects.registry import kinds

ROOM = 25.0
"""°C at which a programme begins and ends: the sensor is handled there."""

REST = 30.0
"""min at the beginning: memories then start from equilibrium, and the noise is read without drift."""

LEAST_SOAK = 15.0
"""min at each end: five time constants of a sensor that follows the air within three minutes."""

RATIO = 2.0
"""Of the fast cycle's rate to the slow one's: a lag makes a loop twice as wide, a hysteresis does not."""

THIRD = 0.7
"""Of the slow cycle's rate: a third rate, which tells a power of the rate from a straight line."""

USUAL_RATE = 2.0
"""°C/min of the fast cycle where the mission is slower: what most ovens can do with a sensor in them."""

MARGIN = 1.25
"""Of the mission's rate: the recordings must bracket it, since no model is right beyond the rates that it saw."""

HOLD_OUT_INSIDE = 1.5
"""°C by which the hold-out stays inside the range learned: it judges the model, not the edge of its range."""

LOOP = (0.3, 0.7)
"""Ends of a minor loop as shares of the range: its return points are those of no other sweep."""

LEAST_SPAN = 10.0
"""°C: over less the drift's shape and its noise are of one size."""

ACCELEROMETER_RATE = 5.0
"""Hz at least: 25 samples in a mean of 5 s tell a shock from its neighbours."""

THERMISTOR_RATE = 1.0
"""Hz at least; 10 Hz halve the error of temperature and rate that the model is fed with."""


class Activity(Enum):
    """What has to be done beside heating; the value says how, to the person at the oven."""

    POWER = "switch the sensor off for 15 min and on again, thermistor included"
    SUPPLY = "step the supply by 1 to 2 % and log it (topic accel/supply_voltage)"
    HEATING = "warm or cool one side of the package by 5 °C for 10 min, log it (topic accel/temperature_2)"
    LATERAL = "turn the sensor so that another axis feels other levels, up to its range where that can be done"
    LEVELS = "spin or tumble to +A, then -A, 30 s each, and back; three sizes of A, each again and again"
    VIBRATION = "shake along the axis for some minutes at several levels, and stop"
    SHOCKS = "hit the sensor along the axis, as often one way as the other, two sizes; quiet before and after"


@dataclass(frozen=True)
class Demand:
    """What an effect asks of a programme.

    why: reason of it. time_constant: s, assumed where it is not known, 0 for an effect without a memory; soak: time
    constants to wait at each end. rates: how many. loop: whether a minor loop. rest: h at one temperature between
    cycles. activity: beside heating.
    """

    why: str
    time_constant: float = 0.0
    soak: float = 0.0
    rates: int = 2
    loop: bool = False
    rest: float = 0.0
    activity: Activity | None = None


DEMANDS: Mapping[str, Demand] = {
    "thermal_lag": Demand("the loop widens with the rate and closes in the soaks", 180.0, 5.0),
    "timing_offset": Demand("sharp corners between ramps and soaks show it; a lag rounds them, a delay shifts them"),
    "hysteresis": Demand("return points inside the range: a minor loop", loop=True),
    "rate_dependent_hysteresis": Demand("three rates give the power of the rate", rates=3),
    "stress_relaxation": Demand("the creep must be seen to come to rest: soaks of 1.5 time constants", 3600.0, 1.5),
    "threshold_step": Demand("each cycle crosses the temperature twice; two cycles, four times"),
    "periodic_interference": Demand("more than twenty periods of it"),
    "warm_up": Demand("power-ons at different temperatures", activity=Activity.POWER),
    "aging": Demand("the same temperatures again a day later", rest=24.0),
    "thermal_gradient": Demand("heat that the thermistor does not see", activity=Activity.HEATING),
    "supply_voltage": Demand("voltage that does not follow the temperature", activity=Activity.SUPPLY),
    "scale_factor_temperature": Demand("the same input at many temperatures", activity=Activity.LEVELS),
    "quadratic_nonlinearity": Demand("inputs of both signs and three sizes", activity=Activity.LEVELS),
    "cross_axis": Demand("acceleration of another axis alone", activity=Activity.LATERAL),
    "vibration_rectification": Demand("vibration on and off at one temperature", activity=Activity.VIBRATION),
    "post_shock_zero_shift": Demand("shocks, and what they leave behind", activity=Activity.SHOCKS),
}
"""By the name of the effect."""

OVEN_ALONE = ("thermal_lag", "timing_offset", "hysteresis", "threshold_step", "periodic_interference")
"""Effects that a programme is for where none is named: they need no more than an oven and half a day."""


def demand_of(name: str) -> Demand:
    """Return what an effect asks; one that this table does not know asks for what its own description says."""
    return DEMANDS.get(name) or Demand(kinds()[name].identified_by or "two cycles at two rates")
