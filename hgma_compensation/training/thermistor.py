"""Settings of the temperature features for the thermistor of a set of recordings."""

from collections.abc import Sequence

import numpy as np

from hgma_compensation.errors import RefusedError
from hgma_compensation.recording.recording import Series
from hgma_compensation.recording.source import Source
from hgma_compensation.stamps import NANOSECONDS
from hgma_compensation.temperature.features import FeatureSettings, Product
from hgma_compensation.temperature.noise import fit_trend_noise
from hgma_compensation.temperature.track import PLAUSIBLE_CELSIUS

HORIZON_INTERVALS = 10
SHORTEST_HORIZON, LONGEST_HORIZON = 2.0, 60.0
"""s: the trend is trusted over ten missed thermistor samples, within these limits."""

LONGEST_LATENCY = 1.0
"""s: thermistor samples are used one interval after their stamp, but no later than this.

A message that is late by less changes nothing, and the trend predicts over the interval with an error far
below the thermistor's noise.
"""

FEWEST = 50
"""Thermistor samples below which their noise cannot be told."""


def feature_settings(
    recordings: Sequence[Source], *, delay: float, product: Product, reference_temperature: float
) -> FeatureSettings:
    """Return settings whose noise is fitted to the recordings' thermistors.

    Raises RefusedError where a recording has no thermistor or too little of it.
    """
    for recording in recordings:
        recording.require_temperature()
    series = [usable(recording.temperature) for recording in recordings]
    series = [one for one in series if len(one.stamps) >= FEWEST]
    if not series:
        names = ", ".join(recording.name for recording in recordings)
        raise RefusedError(f"{names}: fewer than {FEWEST} usable thermistor samples in each: record for longer")
    interval = float(np.median(np.concatenate([np.diff(one.stamps) for one in series])) / NANOSECONDS)
    return FeatureSettings(
        noise=fit_trend_noise([(one.stamps, one.values) for one in series]),
        product=product,
        delay=delay,
        reference_temperature=reference_temperature,
        latency=min(interval, LONGEST_LATENCY),
        prediction_horizon=float(np.clip(HORIZON_INTERVALS * interval, SHORTEST_HORIZON, LONGEST_HORIZON)),
    )


def usable(series: Series) -> Series:
    """Return the plausible samples whose stamps exceed all before them; a recording is taken as one run.

    Jumps are left in: telling them takes the noise, which is fitted to a median that is deaf to them.
    """
    good = (series.stamps > 0) & (series.values >= PLAUSIBLE_CELSIUS[0]) & (series.values <= PLAUSIBLE_CELSIUS[1])
    stamps, values = series.stamps[good], series.values[good]
    if not len(stamps):
        return Series.empty()
    newest = np.maximum.accumulate(stamps)
    forward = np.concatenate([[True], stamps[1:] > newest[:-1]])
    return Series(stamps[forward], values[forward])
