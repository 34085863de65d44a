"""What of a calibration a cubic in temperature cannot carry, in words."""

from collections.abc import Sequence

from hgma_compensation.calibration.calibration import Calibration, ChannelCalibration
from hgma_compensation.drift.polynomial import PolynomialDrift
from hgma_compensation.kalman.settings import FilterMode
from hgma_compensation.temperature.features import FeatureSettings, Product

FILTERS = {
    FilterMode.SMOOTH: "Kalman stage that smooths",
    FilterMode.BIAS: "Kalman stage that follows the bias at rest",
}


def not_carried(calibration: Calibration, channels: Sequence[str]) -> tuple[str, ...]:
    """Return what an autopilot leaves out of these channels, with their names; what is static in it is in the cubic."""
    found: dict[str, list[str]] = {}
    exported = [channel for channel in calibration.channels if channel.name in channels]
    for channel in exported:
        if _answers_to_rate(channel, calibration.features):
            found.setdefault("answer of the drift to the temperature's rate", []).append(channel.name)
    for applied in calibration.effects:
        if applied.channel in channels:
            found.setdefault(f"{applied.effect.title} (effect {applied.effect.name})", []).append(applied.channel)
    for channel in exported:
        if channel.filter.mode is not FilterMode.OFF:
            found.setdefault(FILTERS[channel.filter.mode], []).append(channel.name)
    return tuple(f"{what}: {', '.join(dict.fromkeys(names))}" for what, names in found.items())


def _answers_to_rate(channel: ChannelCalibration, features: FeatureSettings) -> bool:
    drift = channel.drift
    if not isinstance(drift, PolynomialDrift):
        return True
    # With a fixed reference temperature the product is one more function of the temperature alone.
    with_rate = [1, 2] if features.product is Product.DELAY else [1]
    used = drift.exponents[drift.coefficients != 0.0]
    return bool(used[:, with_rate].any())
