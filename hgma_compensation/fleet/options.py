"""What a fleet's sensors are calibrated with, all alike."""

from dataclasses import asdict, dataclass, field, replace
from enum import Enum
from pathlib import Path
from typing import Any

from hgma_compensation import topics
from hgma_compensation.training.train import TrainingOptions


@dataclass(frozen=True)
class FleetOptions:
    """training: as for ``hgma train``; every sensor has the same seed. holdout: name or pattern of what is judged on.

    names: of the topics in the bags.
    """

    training: TrainingOptions = field(default_factory=TrainingOptions)
    names: topics.TopicNames = field(default_factory=topics.TopicNames)
    holdout: str | None = None

    def of(self, sensor: str) -> TrainingOptions:
        """Return what ``hgma train --sensor-id SENSOR`` would train with."""
        return replace(self.training, sensor_id=sensor)

    def as_json(self) -> dict[str, Any]:
        """Return all that a result depends on besides the recordings, as plain values."""
        training = {
            name: value.value if isinstance(value, Enum) else value
            for name, value in asdict(replace(self.training, sensor_id=None)).items()
            if name not in ("sensor_id", "reference")
        }
        return {
            "training": {**training, "reference": str(self.training.reference)},
            "topics": {topic: self.names[topic] for topic in topics.INPUTS},
            "holdout": self.holdout,
        }


@dataclass(frozen=True)
class Job:
    """One sensor to calibrate: the folder ``source / sensor`` into the folder ``output / sensor``."""

    source: Path
    output: Path
    sensor: str
    options: FleetOptions
