"""The effects that a static drift model lacks: one file for each, found by its name in a scenario."""

from hgma_compensation.simulation.effect import Effect
from hgma_compensation.simulation.effects.aging import Aging
from hgma_compensation.simulation.effects.cross_axis import CrossAxis
from hgma_compensation.simulation.effects.humidity import Humidity
from hgma_compensation.simulation.effects.hysteresis import Hysteresis
from hgma_compensation.simulation.effects.periodic_interference import PeriodicInterference
from hgma_compensation.simulation.effects.post_shock_zero_shift import PostShockZeroShift
from hgma_compensation.simulation.effects.quadratic_nonlinearity import QuadraticNonlinearity
from hgma_compensation.simulation.effects.random_walk import RandomWalk
from hgma_compensation.simulation.effects.rate_dependent_hysteresis import RateDependentHysteresis
from hgma_compensation.simulation.effects.scale_factor_temperature import ScaleFactorTemperature
from hgma_compensation.simulation.effects.stress_relaxation import StressRelaxation
from hgma_compensation.simulation.effects.supply_voltage import SupplyVoltage
from hgma_compensation.simulation.effects.telegraph_noise import TelegraphNoise
from hgma_compensation.simulation.effects.thermal_gradient import ThermalGradient
from hgma_compensation.simulation.effects.thermal_lag import ThermalLag
from hgma_compensation.simulation.effects.threshold_step import ThresholdStep
from hgma_compensation.simulation.effects.timing_offset import TimingOffset
from hgma_compensation.simulation.effects.vibration_rectification import VibrationRectification
from hgma_compensation.simulation.effects.warm_up import WarmUp

EFFECTS: dict[str, type[Effect]] = {
    "aging": Aging,
    "cross_axis": CrossAxis,
    "humidity": Humidity,
    "hysteresis": Hysteresis,
    "periodic_interference": PeriodicInterference,
    "post_shock_zero_shift": PostShockZeroShift,
    "quadratic_nonlinearity": QuadraticNonlinearity,
    "random_walk": RandomWalk,
    "rate_dependent_hysteresis": RateDependentHysteresis,
    "scale_factor_temperature": ScaleFactorTemperature,
    "stress_relaxation": StressRelaxation,
    "supply_voltage": SupplyVoltage,
    "telegraph_noise": TelegraphNoise,
    "thermal_gradient": ThermalGradient,
    "thermal_lag": ThermalLag,
    "threshold_step": ThresholdStep,
    "timing_offset": TimingOffset,
    "vibration_rectification": VibrationRectification,
    "warm_up": WarmUp,
}
"""Quantisation, clipping, white and flicker noise are no effects here but fields of an axis."""
