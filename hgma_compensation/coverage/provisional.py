"""The calibration that a check prepares recordings with where none is given: settings of the features, no more."""

from collections.abc import Sequence

import numpy as np

from hgma_compensation.calibration.calibration import Calibration, ChannelCalibration, ChannelError
from hgma_compensation.drift.model import CalibratedRange
from hgma_compensation.drift.polynomial import CUBIC, CUBIC_WITH_RATE
from hgma_compensation.kalman.settings import FilterSettings
from hgma_compensation.recording.recording import Recording
from hgma_compensation.training.blocks import block_means
from hgma_compensation.training.polynomial_fit import fit_polynomial
from hgma_compensation.training.thermistor import feature_settings
from hgma_compensation.training.train import SMALLEST_SPAN, TrainingOptions

STILL = CUBIC[:1]
"""Exponents where the temperature stood still: a constant."""


def provisional(recordings: Sequence[Recording], channels: tuple[str, ...], block: float) -> Calibration:
    """Return a calibration whose drift is a cubic with rate terms, fitted to means of ``block`` s.

    Unlike ``train`` it takes recordings at one temperature, too. Raises RefusedError where a recording has no
    thermistor, or where less than a fit of a dozen coefficients needs is usable.
    """
    options = TrainingOptions()
    settings = feature_settings(
        recordings,
        delay=options.delay,
        product=options.product,
        reference_temperature=options.reference_temperature,
    )
    blocks = block_means(recordings, channels, settings, block)
    exponents = CUBIC_WITH_RATE if np.ptp(blocks.features[:, 0]) >= SMALLEST_SPAN else STILL
    fitted = []
    for column, name in enumerate(channels):
        reference = float(np.mean(blocks.values[:, column]))
        drift = fit_polynomial(blocks.features, blocks.values[:, column] - reference, exponents)
        fitted.append(ChannelCalibration(name, drift, reference, FilterSettings(), ChannelError(0.0, 0.0)))
    return Calibration(
        sensor_id=recordings[0].frame,
        features=settings,
        calibrated_range=CalibratedRange.of(blocks.features),
        channels=tuple(fitted),
        training={},
    )
