"""The calibrations that the rows run with, trained by ``hgma train`` on a recording of the benchmark's sensor."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from benchmarks.bench.bags import Content, bag
from benchmarks.bench.commands import run
from hgma_compensation.calibration.document import read_calibration, with_id, write_calibration
from hgma_compensation.channels import CHANNELS
from hgma_compensation.demo.processes import HGMA
from hgma_compensation.effects.applied import AppliedEffect
from hgma_compensation.effects.registry import make

TRAINING = Content(seconds=4 * 3600.0, rate=2.0)
LAG: dict[str, float | str] = {
    "time_constant": 60.0,
    "lowest": -10.0,
    "highest": 60.0,
    "centres": 0.0,
    "spread": 1.0,
    "poles": 1.0,
}
PLAYS: dict[str, float | str] = {
    "threshold": 4.0,
    "spread": 1.8,
    "bend": 0.0,
    "plays": 3.0,
    "before": -273.15,
    "offset": 0.0,
}
VIBRATION: dict[str, float | str] = {"time_constant": 5.0, "floor": 0.0, "channel": CHANNELS[2]}
EFFECTS: tuple[tuple[str, str, dict[str, float | str], tuple[float, ...]], ...] = (
    (CHANNELS[0], "thermal_lag", LAG, (0.01,)),
    (CHANNELS[1], "hysteresis", PLAYS, (0.01, 0.01, 0.01)),
    (CHANNELS[2], "vibration_rectification", VIBRATION, (1e-5,)),
)
"""One memory of each sort: of the temperature's past, of its turns, and of every sample."""


class Calibrations:
    """Files in a folder, each made when it is first asked for."""

    def __init__(self, folder: Path, bags: Path) -> None:
        """Keep files in a folder that is empty at the start of a run, and bags where others may have left them."""
        self._folder, self._bags = folder, bags

    def plain(self) -> Path:
        """Return the one of a training with default settings: three networks, no filter."""
        return self._made("plain", lambda path: self._train(path))

    def smooth(self) -> Path:
        """Return the same with the smoothing Kalman stage."""
        return self._made("smooth", lambda path: self._train(path, "--filter", "smooth"))

    def with_effects(self) -> Path:
        """Return the plain one with effects added."""
        return self._made("effects", self._add_effects)

    def _made(self, name: str, make_file: Callable[[Path], None]) -> Path:
        path = self._folder / f"{name}.json"
        if not path.exists():
            make_file(path)
        return path

    def _train(self, path: Path, *options: str) -> None:
        run([*HGMA, "train", bag(TRAINING, self._bags), "-o", path, *options])

    def _add_effects(self, path: Path) -> None:
        applied = [
            AppliedEffect(channel, make(name, given), np.array(gains)) for channel, name, given, gains in EFFECTS
        ]
        write_calibration(with_id(replace(read_calibration(self.plain()), effects=tuple(applied))), path)
