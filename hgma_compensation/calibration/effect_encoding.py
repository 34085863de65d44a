"""Effects of a calibration as plain JSON, and back."""

from itertools import product
from typing import Any

import numpy as np

from hgma_compensation.calibration.bounds import LARGEST_EFFECT, largest_drift
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
    "acceleration": (-1.0, 1.0),
}
"""What an effect may meet beside the calibrated range; acceleration: in parts of the largest, which alternate."""

INTERVAL = 9
"""s between samples that are probed: as far apart as samples may be for a memory of the acceleration to go on."""

LAST_STAMP = (1 << 31) * NANOSECONDS
"""ns: the end of builtin_interfaces/Time, when aging has gone furthest."""

MARGIN = 2.0
"""By which a memory that has not quite settled over the probe may still grow."""


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
    """Raise RefusedError for an effect on a channel without calibration, or one that overflows somewhere.

    Each effect is probed with all that those before it may have done to the acceleration that it sees.
    """
    largest = LARGEST_ACCELERATION
    with np.errstate(all="ignore"):
        box = calibration.calibrated_range
        largest += max(abs(c.reference) + largest_drift(c.drift, box) for c in calibration.channels)
        # Those that do not bend with the acceleration are added first, wherever they stand in the list.
        for index, applied in sorted(enumerate(calibration.effects), key=lambda item: item[1].effect.per_sample):
            if applied.channel not in calibration.names:
                raise RefusedError(
                    f"effects[{index}].channel is {applied.channel!r}, "
                    f"must be calibrated: {', '.join(calibration.names)}"
                )
            largest += MARGIN * float(np.abs(_probe(applied, box, largest)).max())
            if not largest <= LARGEST_EFFECT:
                raise RefusedError(f"effects[{index}] overflows inside the calibrated range: its numbers are damaged")


def _probe(applied: AppliedEffect, box: CalibratedRange, largest: float) -> Array:
    """Return the effect's drift (n,) in all corners of what it may meet, accelerations up to the largest."""
    features = box.corners()
    corners = list(product(range(len(features)), *PROBED.values()))
    rows, since, other, volts, acceleration = (np.array(column) for column in zip(*corners, strict=True))
    before = np.clip(other, box.lower[0], box.upper[0])
    at = Conditions(
        stamps=LAST_STAMP + np.arange(-len(rows), 0) * (INTERVAL * NANOSECONDS),
        since_power_on=since,
        temperature=features[rows, 0],
        rate=features[rows, 1],
        earlier=lambda _: before,
        temperature_2=other,
        supply_voltage=volts,
        acceleration=np.repeat(largest * acceleration[:, None], len(CHANNELS), axis=1),
    )
    return applied.drift(at, _states(applied, at, before))


def _states(applied: AppliedEffect, at: Conditions, temperature: Array) -> Array:
    """Return states (n, m) of a past at other temperatures (n,), and of the accelerations."""
    parts = [np.empty((len(at), 0))]
    memory, driven = applied.effect.memory(), applied.effect.acceleration_memory()
    if memory is not None:
        different, places = np.unique(temperature, return_inverse=True)
        parts.append(np.stack([memory.start(value[None]) for value in different])[places])
    if driven is not None:
        parts.append(driven.run(driven.start(), at.stamps, at.acceleration[:, 0]))
    return np.concatenate(parts, axis=1)
