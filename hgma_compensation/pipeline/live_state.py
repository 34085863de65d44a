"""What a node keeps over a restart, as an object and as a plain JSON document."""

from dataclasses import asdict, dataclass, field
from typing import Any

from hgma_compensation.effects.effect import Need
from hgma_compensation.pipeline.condensed import condensed
from hgma_compensation.pipeline.remembered import Remembered
from hgma_compensation.pipeline.settling import MemorySpan

Document = dict[str, Any]

ACCELERATION = "acceleration"
INPUTS: dict[Need | None, str] = {
    None: "temperature",
    Need.TEMPERATURE_2: Need.TEMPERATURE_2.value,
    Need.SUPPLY_VOLTAGE: Need.SUPPLY_VOLTAGE.value,
}
"""Names of the slow inputs; None is the thermistor."""


@dataclass(frozen=True)
class LiveState:
    """The memory of a LiveCompensation at one moment.

    calibration_id, sensor_id: of the calibration in use, "" without one. pipeline: its snapshot. remembered: samples
    of the slow inputs. span: what the thermistor went through. acceleration: newest stamp of the accelerometer, ns.
    """

    calibration_id: str = ""
    sensor_id: str = ""
    pipeline: Document | None = None
    remembered: dict[Need | None, Remembered] = field(default_factory=dict)
    span: MemorySpan = field(default_factory=MemorySpan)
    acceleration: int | None = None

    def newest(self) -> dict[str, int]:
        """Return the newest stamp, ns, of each input that has come."""
        stamps = {INPUTS[need]: last for need, kept in self.remembered.items() if (last := kept.newest) is not None}
        return stamps if self.acceleration is None else {**stamps, ACCELERATION: self.acceleration}


def encode_state(state: LiveState) -> Document:
    """Return the document of a state; its samples are condensed."""
    return {
        "calibration_id": state.calibration_id,
        "sensor_id": state.sensor_id,
        "acceleration": state.acceleration,
        "span": asdict(state.span),
        "inputs": {INPUTS[need]: _encode_samples(kept) for need, kept in state.remembered.items()},
        "pipeline": state.pipeline,
    }


def _encode_samples(remembered: Remembered) -> Document:
    kept = condensed(remembered)
    samples = list(kept)
    return {"power_on": kept.power_on, "stamps": [s for s, _ in samples], "values": [v for _, v in samples]}


def decode_state(document: Document) -> LiveState:
    """Return the state of a document that follows the schema; raises ValueError for lists of unequal length."""
    return LiveState(
        calibration_id=document["calibration_id"],
        sensor_id=document["sensor_id"],
        pipeline=document["pipeline"],
        remembered={need: _decode_samples(document["inputs"][name], f"inputs.{name}") for need, name in INPUTS.items()},
        span=_decode_span(document["span"]),
        acceleration=_stamp(document["acceleration"]),
    )


def _decode_samples(document: Document, path: str) -> Remembered:
    if len(document["stamps"]) != len(document["values"]):
        raise ValueError(f"{path} has {len(document['stamps'])} stamps and {len(document['values'])} values")
    samples = zip(map(int, document["stamps"]), map(float, document["values"]), strict=True)
    return Remembered.of(_stamp(document["power_on"]), samples)


def _decode_span(document: Document) -> MemorySpan:
    began, newest = _stamp(document["began"]), _stamp(document["newest"])
    return MemorySpan(began, newest, float(document["lowest"]), float(document["highest"]))


def _stamp(value: float | None) -> int | None:
    return None if value is None else int(value)
