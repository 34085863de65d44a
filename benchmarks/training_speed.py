"""Time and held-out error of training against a Gaussian process and kernel ridge regression, on the same blocks.

A simulated oven test of the paper: twelve hours to train on, then a cycle at a ramp rate that they lack. Only fits are
timed: the means that all three are fitted to are made once. One call is one repetition; alternate and repeat calls for
medians. Run: python -m benchmarks.training_speed --seeds 3
"""

import argparse
import json
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from functools import lru_cache

import numpy as np

from benchmarks.paper_oven import PARAMETERS, held_out_start
from hgma_compensation.drift.inputs import Array
from hgma_compensation.drift.model import CalibratedRange, DriftModel
from hgma_compensation.recording.recording import Recording
from hgma_compensation.simulation.oven_test import simulate
from hgma_compensation.simulation.scenario import Scenario, read_scenario
from hgma_compensation.temperature.features import FeatureSettings
from hgma_compensation.training.baselines import MOST_POINTS, fit_gaussian_process, fit_kernel_ridge
from hgma_compensation.training.blocks import Blocks, block_means
from hgma_compensation.training.folds import Folds, cycle_folds
from hgma_compensation.training.reference import Reference
from hgma_compensation.training.thermistor import feature_settings
from hgma_compensation.training.train import TrainingOptions, block_length, train_on_blocks

HOURS = 12.0
"""Of the recording that is trained on; the held-out cycle comes after."""


@dataclass(frozen=True)
class TrainingSpeed:
    """Seconds of a fit and RMS error, m/s², of means over ``block`` s of a cycle that no fit has seen.

    blocks: means that network and kernel ridge are fitted to; gaussian_process_points: of these, those that the process
    is fitted to. noise: RMS, m/s², of such a mean by white noise, for comparison with the errors.
    """

    seed: int
    blocks: int
    block: float
    gaussian_process_points: int
    network_seconds: float
    gaussian_process_seconds: float
    kernel_ridge_seconds: float
    network_error: float
    gaussian_process_error: float
    kernel_ridge_error: float
    noise: float


@dataclass(frozen=True)
class Material:
    """Blocks to train on and blocks held out of one recording, and what training wants to know beside them."""

    training: Recording
    channel: str
    true_value: float
    settings: FeatureSettings
    block: float
    blocks: Blocks
    unseen: Blocks
    noise: float

    @property
    def folds(self) -> Folds:
        """Temperature cycles, as training validates."""
        return cycle_folds(self.blocks)

    @property
    def target(self) -> Array:
        """Drift (n,), m/s²."""
        return np.asarray(self.blocks.values[:, 0] - self.true_value)

    def error(self, drift: DriftModel) -> float:
        """Return the RMS error on the held-out blocks, m/s²; features clamped to those trained on, as in a node."""
        features = CalibratedRange.of(self.blocks.features).clamp(self.unseen.features)
        left = self.unseen.values[:, 0] - self.true_value - drift.evaluate(features)
        return float(np.sqrt(np.mean(left**2)))


def measure(seed: int, points: int | None = MOST_POINTS) -> TrainingSpeed:
    """Return times and errors of the three fits, once each, one after the other.

    points: means that the Gaussian process is fitted to, drawn with the seed; None for all blocks, which takes minutes.
    Fewer make it faster, and on these recordings no worse.
    """
    material = make_material(seed)
    target, folds = material.target, material.folds
    count = len(target) if points is None else min(points, len(target))
    network, network_seconds = _timed(lambda: _network(material, seed))
    process, process_seconds = _timed(
        lambda: fit_gaussian_process(material.blocks.features, target, seed=seed, points=count)
    )
    kernel, kernel_seconds = _timed(lambda: fit_kernel_ridge(material.blocks.features, target, folds))
    return TrainingSpeed(
        seed=seed,
        blocks=len(target),
        block=material.block,
        gaussian_process_points=count,
        network_seconds=network_seconds,
        gaussian_process_seconds=process_seconds,
        kernel_ridge_seconds=kernel_seconds,
        network_error=material.error(network),
        gaussian_process_error=material.error(process),
        kernel_ridge_error=material.error(kernel),
        noise=material.noise,
    )


@lru_cache(maxsize=1)
def make_material(seed: int) -> Material:
    """Return the material of one simulated sensor; seed 1 is the scenario as it is written."""
    written = read_scenario(PARAMETERS / "paper_oven_test.yaml")
    scenario = lengthened(replace(written, seed=written.seed + seed - 1), HOURS)
    axis = next(iter(scenario.axes))
    described, channel = scenario.axes[axis], f"linear_acceleration.{axis}"
    whole, split = simulate(scenario), held_out_start(scenario.oven)
    training = whole.cut(None, split)
    defaults = TrainingOptions()
    settings = feature_settings(
        [training],
        delay=defaults.delay,
        product=defaults.product,
        reference_temperature=defaults.reference_temperature,
    )
    block = block_length([training], defaults.block)
    means = block_means([whole], [channel], settings, block)
    seen = means.time < split
    noise = described.white_noise / float(np.sqrt(block))
    return Material(
        training, channel, described.true_value, settings, block, means.select(seen), means.select(~seen), noise
    )


def lengthened(scenario: Scenario, hours: float) -> Scenario:
    """Return the scenario with its soaks before the held-out cycle as long as makes that part last ``hours``."""
    steps = scenario.oven.program
    count = sum(step.rate != steps[-1].rate for step in steps)
    more = (3600.0 * hours - held_out_start(scenario.oven)) / (60.0 * count)
    program = tuple(replace(s, soak=s.soak + more) if s.rate != steps[-1].rate else s for s in steps)
    return replace(scenario, oven=replace(scenario.oven, program=program))


def _network(material: Material, seed: int) -> DriftModel:
    """Return the network of a whole training, its calibration's other parts made too."""
    options = TrainingOptions(seed=seed, reference=Reference((material.true_value,)))
    recordings, channels = [material.training], (material.channel,)
    calibration = train_on_blocks(material.blocks, recordings, channels, material.settings, material.block, options)
    return calibration.channels[0].drift


def _timed(fit: Callable[[], DriftModel]) -> tuple[DriftModel, float]:
    start = time.perf_counter()
    fitted = fit()
    return fitted, time.perf_counter() - start


def main() -> None:
    """Print one line of JSON for each seed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=1, help="how many sensors")
    parser.add_argument("--points", type=int, default=MOST_POINTS, help="of the Gaussian process; 0 for all blocks")
    chosen = parser.parse_args()
    for seed in range(1, chosen.seeds + 1):
        print(json.dumps(asdict(measure(seed, chosen.points or None))), flush=True)


if __name__ == "__main__":
    main()
