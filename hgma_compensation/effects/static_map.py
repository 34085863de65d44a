"""The static drift map of effects that see it at another temperature than the thermistor's."""

import numpy as np

from hgma_compensation.effects.effect import Array, Span
from hgma_compensation.effects.requirements import require_whole
from hgma_compensation.errors import RefusedError

MAP_SPANS = {
    "lowest": Span("°C", -100.0, 250.0, searched=False),
    "highest": Span("°C", -100.0, 250.0, searched=False),
    "centres": Span("", 0.0, 20.0, searched=False),
}
FINE = 8.0
"""Number of Gaussians that, beside the linear term, follows a quintic to 0.5 % of its span."""

_OVERLAP = 1.2


def check_map(lowest: float, highest: float, centres: float) -> None:
    """Raise RefusedError where these parameters, each inside its span, make no map."""
    require_whole("centres", centres)
    if centres and highest <= lowest:
        raise RefusedError(f"highest is {highest!r}, must be above lowest, which is {lowest!r}")


def map_difference(sensed: Array, temperature: Array, lowest: float, highest: float, centres: float) -> Array:
    """Return b(sensed) − b(temperature), (n, 1 + centres), of the basis b(T) = (T, G₁(T), G₂(T), …).

    sensed, temperature: (n,) °C. G are Gaussians evenly placed over lowest…highest, 1.2 spacings wide. They are
    counted in °C, so that all gains have one unit.
    """
    linear = (sensed - temperature)[:, None]
    if not centres:
        return linear
    places = np.linspace(lowest, highest, int(centres))
    width = _OVERLAP * (highest - lowest) / max(centres - 1.0, 1.0)
    return np.hstack([linear, _gaussians(sensed, places, width) - _gaussians(temperature, places, width)])


def _gaussians(temperature: Array, places: Array, width: float) -> Array:
    distance = (temperature[:, None] - places) / width
    return np.asarray(np.exp(-0.5 * distance * distance))
