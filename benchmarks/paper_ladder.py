"""The rows of the paper's table as calibrations, each made from the training cycles alone."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

from benchmarks.paper_oven import PARAMETERS, STILL_HOURS, OvenTest, oven_test
from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.drift.model import DriftModel
from hgma_compensation.evaluation.noise_figures import Stage
from hgma_compensation.kalman.settings import FilterMode
from hgma_compensation.temperature.features import FeatureSettings, Product
from hgma_compensation.training.baselines import fit_gaussian_process, fit_thin_plate
from hgma_compensation.training.blocks import Blocks, block_means
from hgma_compensation.training.filter_design import TIME_CONSTANTS, design_filter
from hgma_compensation.training.folds import cycle_folds
from hgma_compensation.training.genetic import GeneticSettings
from hgma_compensation.training.methods import Method
from hgma_compensation.training.reference import Reference
from hgma_compensation.training.thermistor import feature_settings
from hgma_compensation.training.train import TrainingOptions, block_length, train_on_blocks

FILTER_TIME_CONSTANT = 150.0
"""s: long enough for both of the paper's noise ratios on a still record at 10 Hz, with the margin that B needs."""

ORIGINAL = "original"
RBF = "RBF NN, Eq. (6)"
RBF_GA = "RBF NN + GA"
RBF_GA_KF = "RBF NN + GA + KF"
DRIFT_MODEL_KF = "RBF NN + GA + KF, drift model"
DRIFT_MODEL = "RBF NN + GA, drift model, no KF"
DRIFT_MODEL_BIAS = "RBF NN + GA, drift model, KF on the bias"
CUBIC = "cubic in T"
CUBIC_RATE = "cubic with Ṫ and T·Ṫ"
GAUSSIAN_PROCESS = "Gaussian process"
THIN_PLATE = "thin-plate spline"

LADDER = (ORIGINAL, RBF, RBF_GA, RBF_GA_KF, DRIFT_MODEL_KF)
"""The paper's rows, in its order."""

ALONE = (DRIFT_MODEL, DRIFT_MODEL_BIAS)
BASELINES = (CUBIC, CUBIC_RATE, GAUSSIAN_PROCESS, THIN_PLATE)

Progress = Callable[[str], None]


@dataclass(frozen=True)
class Experiment:
    """What is simulated, and how long the search may take. still_hours: of the record at rest."""

    scenario: Path = PARAMETERS / "paper_oven_test.yaml"
    genetic: GeneticSettings = field(default_factory=GeneticSettings)
    still_hours: float = STILL_HOURS

    def run(self, seed: int, progress: Progress = lambda name: None) -> tuple[OvenTest, "Rows"]:
        """Return the simulated test and all rows trained on it."""
        test = oven_test(self.scenario, seed, self.still_hours)
        return test, Trainer(test, seed, self.genetic).rows(progress)


@dataclass(frozen=True)
class Rows:
    """Calibrations by the name of their row, ORIGINAL left out, and the stages of those that have one."""

    calibrations: dict[str, Calibration]
    stages: dict[str, Stage]


@dataclass(frozen=True)
class Trainer:
    """Trains rows on one oven test with one seed."""

    test: OvenTest
    seed: int
    genetic: GeneticSettings
    time_constant: float = FILTER_TIME_CONSTANT

    def rows(self, progress: Progress) -> Rows:
        """Return all rows."""
        full = block_means([self.test.training], [self.test.channel], self._settings, self._block)
        static = temperature_alone(full)
        made: dict[str, Calibration] = {}
        for name, method, blocks in (
            (RBF, Method.RBF, static),
            (RBF_GA, Method.RBF_GA, static),
            (DRIFT_MODEL, Method.RBF_GA, full),
            (CUBIC, Method.POLYNOMIAL, full),
            (CUBIC_RATE, Method.POLYNOMIAL_RATE, full),
        ):
            progress(name)
            made[name] = self._train(method, blocks)
        progress(GAUSSIAN_PROCESS)
        made |= self._baselines(made[CUBIC_RATE], full)
        made[RBF_GA_KF] = self._filtered(made[RBF_GA], FilterMode.SMOOTH)
        made[DRIFT_MODEL_KF] = self._filtered(made[DRIFT_MODEL], FilterMode.SMOOTH)
        made[DRIFT_MODEL_BIAS] = self._filtered(made[DRIFT_MODEL], FilterMode.BIAS)
        smooth, bias = Stage(self.time_constant), Stage(TIME_CONSTANTS[FilterMode.BIAS], smooths=False)
        return Rows(made, {RBF_GA_KF: smooth, DRIFT_MODEL_KF: smooth, DRIFT_MODEL_BIAS: bias})

    @cached_property
    def _settings(self) -> FeatureSettings:
        return feature_settings([self.test.training], delay=60.0, product=Product.DELAY, reference_temperature=25.0)

    @property
    def _block(self) -> float:
        return block_length([self.test.training], TrainingOptions.block)

    def _train(self, method: Method, blocks: Blocks) -> Calibration:
        """Return a calibration; inputs that never varied are clamped away by its calibrated range."""
        recording = self.test.training
        reference = Reference((self.test.true_value,))
        options = TrainingOptions(method=method, seed=self.seed, reference=reference, genetic=self.genetic)
        return train_on_blocks(blocks, [recording], (self.test.channel,), self._settings, self._block, options)

    def _baselines(self, pattern: Calibration, blocks: Blocks) -> dict[str, Calibration]:
        target = blocks.values[:, 0] - self.test.true_value
        process = fit_gaussian_process(blocks.features, target, seed=self.seed)
        plate = fit_thin_plate(blocks.features, target, cycle_folds(blocks), seed=self.seed)
        return {GAUSSIAN_PROCESS: with_drift(pattern, process), THIN_PLATE: with_drift(pattern, plate)}

    def _filtered(self, calibration: Calibration, mode: FilterMode) -> Calibration:
        """Return the calibration with a Kalman stage designed on the training cycles."""
        channel, recording = calibration.channels[0], self.test.training
        values = self.test.column(recording)
        time_constant = self.time_constant if mode is FilterMode.SMOOTH else None
        block = float(calibration.training["block"])
        stage = design_filter(
            mode, time_constant, recording.stamps, values, channel.name, error=channel.error.unseen, block=block
        )
        return replace(calibration, channels=(replace(channel, filter=stage),))


def temperature_alone(blocks: Blocks) -> Blocks:
    """Return the blocks with the temperature as the only input that varies."""
    features = blocks.features.copy()
    features[:, 1:] = 0.0
    return replace(blocks, features=features)


def with_drift(pattern: Calibration, drift: DriftModel) -> Calibration:
    """Return the calibration with another drift model; only for comparison, it is never written."""
    return replace(pattern, channels=(replace(pattern.channels[0], drift=drift),))
