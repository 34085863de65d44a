"""The cubic in temperature that stands for a channel's drift, and how far it is from it."""

from dataclasses import dataclass

import numpy as np

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.drift.inputs import Array
from hgma_compensation.errors import RefusedError
from hgma_compensation.migration.steady_drift import steady_drift

POINTS = 1001
"""Temperatures that the cubic is fitted to, evenly over the range: for 100 °C one each 0.1 °C."""

RATES = 41
"""Rates over the calibrated range at which the loss is looked at, beside the temperatures."""

DEGREE = 3


@dataclass(frozen=True)
class Span:
    """Temperatures for which the coefficients hold, °C; reference: the temperature that they are about."""

    lowest: float
    highest: float
    reference: float

    def grid(self, points: int = POINTS) -> Array:
        """Return temperatures (points,) evenly from the lowest to the highest."""
        return np.linspace(self.lowest, self.highest, points)


@dataclass(frozen=True)
class Cubic:
    """Drift of a channel = Σ coefficientsᵢ·(T − reference)ⁱ, i = 0...3, in its unit; (4,), T in °C."""

    channel: str
    reference: float
    coefficients: Array

    def evaluate(self, temperature: Array) -> Array:
        """Return the drift (n,)."""
        return np.asarray(np.polynomial.polynomial.polyval(temperature - self.reference, self.coefficients))


@dataclass(frozen=True)
class Difference:
    """Cubic less full model over some conditions, in the channel's unit; worst at temperature, °C, and rate, °C/s."""

    rms: float
    worst: float
    temperature: float
    rate: float


@dataclass(frozen=True)
class FittedCubic:
    """A cubic, and what it loses: at_rest, at a temperature that stands still; over_rates, over the calibrated range.

    steepest: largest slope in the span, unit/°C.
    """

    cubic: Cubic
    at_rest: Difference
    over_rates: Difference
    steepest: float


def span_of(calibration: Calibration, reference: float | None, wanted: tuple[float, float] | None = None) -> Span:
    """Return the calibrated temperatures, or the part of them that is wanted, °C; reference: None for their middle.

    Raises RefusedError where nothing is wanted that is calibrated.
    """
    box = calibration.calibrated_range
    lowest, highest = float(box.lower[0]), float(box.upper[0])
    if wanted is not None:
        first, last = wanted
        if not first < last:
            raise RefusedError(f"--range {first:g} {last:g} is empty: give the lower temperature first")
        if last <= lowest or first >= highest:
            raise RefusedError(
                f"--range {first:g} {last:g}: the calibration covers {lowest:.4g} to {highest:.4g} °C only, "
                "choose temperatures inside of it"
            )
        lowest, highest = max(lowest, first), min(highest, last)
    return Span(lowest, highest, 0.5 * (lowest + highest) if reference is None else reference)


def fit_cubics(calibration: Calibration, span: Span) -> tuple[FittedCubic, ...]:
    """Return the cubic of each channel that is closest to the drift at rest, every temperature counting alike.

    At rest, because an autopilot knows no rate: that is where it spends its time once it is warm, and where every
    part of the model that answers to the rate vanishes. A mean over the calibrated rates would take in corners of the
    range, high rates at the ends of the temperature, that no oven test visits.
    """
    temperature = span.grid()
    drift = steady_drift(calibration, temperature, np.zeros(len(temperature)))
    box = calibration.calibrated_range
    rates = np.linspace(box.lower[1], box.upper[1], RATES)
    ramps = [np.ravel(axis) for axis in np.meshgrid(span.grid(POINTS // 5), rates)]
    over_rates = steady_drift(calibration, *ramps)
    return tuple(
        _fitted(
            Cubic(name, span.reference, _coefficients(temperature - span.reference, drift[:, column])),
            (temperature, np.zeros(len(temperature)), drift[:, column]),
            (ramps[0], ramps[1], over_rates[:, column]),
        )
        for column, name in enumerate(calibration.names)
    )


def _coefficients(temperature: Array, drift: Array) -> Array:
    """Return the least-squares coefficients (4,), lowest power first."""
    # Fitted in -1...1 and then expanded: powers of tens of degrees make an ill-conditioned matrix.
    found = np.polynomial.Polynomial.fit(temperature, drift, DEGREE).convert().coef
    return np.pad(found, (0, DEGREE + 1 - len(found)))


def _fitted(cubic: Cubic, rest: tuple[Array, Array, Array], ramps: tuple[Array, Array, Array]) -> FittedCubic:
    slope = np.polynomial.polynomial.polyder(cubic.coefficients)
    steepness = np.abs(np.polynomial.polynomial.polyval(rest[0] - cubic.reference, slope))
    return FittedCubic(cubic, _difference(cubic, *rest), _difference(cubic, *ramps), float(steepness.max()))


def _difference(cubic: Cubic, temperature: Array, rate: Array, drift: Array) -> Difference:
    error = cubic.evaluate(temperature) - drift
    worst = int(np.argmax(np.abs(error)))
    return Difference(
        rms=float(np.sqrt(np.mean(error**2))),
        worst=float(np.abs(error[worst])),
        temperature=float(temperature[worst]),
        rate=float(rate[worst]),
    )
