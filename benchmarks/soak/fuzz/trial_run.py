"""Runs what was accepted: from finite inputs nothing may come that is not finite, whatever the temperature."""

import math
import random

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.drift.model import DriftModel
from hgma_compensation.drift.polynomial import PolynomialDrift
from hgma_compensation.drift.radial_basis import RadialBasisDrift
from hgma_compensation.pipeline.pipeline import Pipeline
from hgma_compensation.stamps import NANOSECONDS

LARGEST = 1e6
"""m/s²."""

START = 1_700_000_000 * NANOSECONDS
SAMPLES = 64
TOLERANCE = 1e-6
"""Of the sum of the magnitudes of a drift's terms."""


def problem_of(calibration: Calibration, chance: random.Random) -> str | None:
    """Return what is wrong with the output of a calibration that was accepted, None where nothing is."""
    random_numbers = np.random.default_rng(chance.getrandbits(63))
    box = calibration.calibrated_range
    pipeline = Pipeline(calibration)
    interval = chance.choice((1_000, 1_000_000, 100_000_000, 20 * NANOSECONDS, 3600 * NANOSECONDS))
    for stamp in range(START - 40 * NANOSECONDS, START + SAMPLES * interval, max(interval * 3, 2 * NANOSECONDS)):
        low, high = float(box.lower[0]), float(box.upper[0])
        pipeline.add_temperature(stamp, chance.choice((chance.uniform(low, high), chance.uniform(-270.0, 400.0), high)))
        pipeline.add_temperature_2(stamp, chance.uniform(-100.0, 250.0))
        pipeline.add_supply_voltage(stamp, chance.uniform(0.0, 100.0))
    stamps = START + np.arange(SAMPLES) * interval
    values = random_numbers.uniform(-LARGEST, LARGEST, (SAMPLES, 6))
    values[::3] = random_numbers.choice([-LARGEST, LARGEST], (len(values[::3]), 6))
    values[SAMPLES // 2 :: 5] = 9.81
    columns = pipeline.columns.read[: len(calibration.names)]
    result = pipeline.compensate(stamps, values[:, columns], values)
    for name in ("values", "drift", "innovation"):
        if not np.isfinite(getattr(result, name)).all():
            return f"{name} is not finite"
    return _wrong_drift(calibration, random_numbers.uniform(box.lower, box.upper))


def _wrong_drift(calibration: Calibration, at: NDArray[np.float64]) -> str | None:
    """Compare the drift models at one point of the box with plain sums of the published formulae."""
    for channel in calibration.channels:
        ours = float(channel.drift.evaluate(at[None])[0])
        terms = _terms(channel.drift, at.tolist())
        if not abs(ours - math.fsum(terms)) <= TOLERANCE * sum(map(abs, terms)) + 1e-300:
            return f"the drift of {channel.name} is {ours!r}, the formula gives {math.fsum(terms)!r}"
    return None


def _terms(drift: DriftModel, at: list[float]) -> list[float]:
    assert isinstance(drift, (RadialBasisDrift, PolynomialDrift))
    x = [(value - o) / s for value, o, s in zip(at, drift.scaling.offset, drift.scaling.scale, strict=True)]
    if isinstance(drift, PolynomialDrift):
        powers = [math.prod(v ** int(e) for v, e in zip(x, row, strict=True)) for row in drift.exponents]
        return [float(c) * p for c, p in zip(drift.coefficients, powers, strict=True)]
    terms = [drift.bias, *(float(k) * v for k, v in zip(drift.linear, x, strict=True))]
    for centre, width, weight in zip(drift.centres, drift.widths, drift.weights, strict=True):
        square = sum(((v - c) / w) ** 2 for v, c, w in zip(x, centre.tolist(), width.tolist(), strict=True))
        terms.append(float(weight) * math.exp(-0.5 * square))
    return terms
