"""Effects of a calibration as plain JSON, and back."""

from itertools import product
from typing import Any

import numpy as np

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.channels import CHANNELS
from hgma_compensation.drift.model import CalibratedRange
from hgma_compensation.effects.applied import AppliedEffect
from hgma_compensation.effects.conditions import Conditions
from hgma_compensation.effects.effect import Array
from hgma_compensation.effects.registry import make
from hgma_compensation.errors import RefusedError
from hgma_compensation.stamps import NANOSECONDS

Document = dict[str, Any]

LARGEST_ACCELERATION = 1e6
"""m/s², and rad/s: a hundred thousand g, beyond any sensor of this kind."""

PROBED = {
    "since_power_on": (0.0, 1e7),
    "other_temperature": (-100.0, 250.0),
    "supply_voltage": (0.0, 100.0),
    "acceleration": (-LARGEST_ACCELERATION, 0.0, LARGEST_ACCELERATION),
}


def encode_effect(applied: AppliedEffect) -> Document:
    """Return the document of an effect."""
    return {
        "effect": applied.effect.name,
        "channel": applied.channel,
        "parameters": applied.effect.parameters(),
        "gains": applied.gains.tolist(),
    }


def decode_effect(document: Document, path: str) -> AppliedEffect:
    """Return the effect of a document that follows the schema; raises RefusedError, naming the field under path."""
    try:
        effect = make(document["effect"], document["parameters"])
    except RefusedError as refusal:
        raise RefusedError(f"{path}.{refusal}") from None
    gains = np.array(document["gains"], dtype=np.float64)
    if len(gains) != effect.count:
        raise RefusedError(f"{path}.gains has {len(gains)} elements, must have {effect.count} with these parameters")
    own = effect.parameters().get("channel", document["channel"])
    if own != document["channel"]:
        raise RefusedError(f"{path}.parameters.channel is {own!r}, must be {document['channel']!r}, the effect's own")
    return AppliedEffect(document["channel"], effect, gains)


def check_effects(calibration: Calibration) -> None:
    """Raise RefusedError for an effect on a channel without calibration, or one that is not finite somewhere."""
    for index, applied in enumerate(calibration.effects):
        if applied.channel not in calibration.names:
            raise RefusedError(
                f"effects[{index}].channel is {applied.channel!r}, must be calibrated: {', '.join(calibration.names)}"
            )
        with np.errstate(all="ignore"):
            drift = _probe(applied, calibration.calibrated_range)
        if not np.isfinite(drift).all():
            raise RefusedError(f"effects[{index}] overflows inside the calibrated range: its numbers are damaged")


def _probe(applied: AppliedEffect, box: CalibratedRange) -> Array:
    """Return the effect's drift (n,) in all corners of what it may meet."""
    features = box.corners()
    corners = list(product(range(len(features)), *PROBED.values()))
    rows, since, other, volts, acceleration = (np.array(column) for column in zip(*corners, strict=True))
    at = Conditions(
        stamps=np.arange(len(rows)) * NANOSECONDS,
        since_power_on=since,
        temperature=features[rows, 0],
        rate=features[rows, 1],
        earlier=lambda _: np.clip(other, box.lower[0], box.upper[0]),
        temperature_2=other,
        supply_voltage=volts,
        acceleration=np.repeat(acceleration[:, None], len(CHANNELS), axis=1),
    )
    return applied.drift(at, _states(applied, at, np.clip(other, box.lower[0], box.upper[0])))


def _states(applied: AppliedEffect, at: Conditions, temperature: Array) -> Array:
    """Return states (n, m) of a past at other temperatures (n,), and of the accelerations."""
    parts = [np.empty((len(at), 0))]
    memory, driven = applied.effect.memory(), applied.effect.acceleration_memory()
    if memory is not None:
        parts.append(np.stack([memory.start(value[None]) for value in temperature]))
    if driven is not None:
        parts.append(driven.run(driven.start(), at.stamps, at.acceleration[:, 0]))
    return np.concatenate(parts, axis=1)
