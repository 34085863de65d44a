"""Cases: recordings of one simulated sensor, the effects behind them, and what a diagnosis must do without."""

import zlib
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from benchmarks.loop import other_sensor, project_sensor
from benchmarks.loop.experiment import HARMLESS, NEEDS
from benchmarks.loop.happenings import experiment
from benchmarks.loop.other_unknown import UNKNOWN
from benchmarks.loop.programme import HOURS
from benchmarks.loop.truth import Truth
from hgma_compensation.recording.recording import Recording

CHANNEL = "linear_acceleration.z"
"""The one that is trained, diagnosed and judged."""

EFFECTS = (
    "thermal_lag",
    "timing_offset",
    "hysteresis",
    "warm_up",
    "aging",
    "stress_relaxation",
    "thermal_gradient",
    "supply_voltage",
    "scale_factor_temperature",
    "quadratic_nonlinearity",
    "vibration_rectification",
    "post_shock_zero_shift",
    "threshold_step",
    "periodic_interference",
    "cross_axis",
)

PAIRS = (
    ("thermal_lag", "warm_up"),
    ("thermal_lag", "supply_voltage"),
    ("timing_offset", "periodic_interference"),
    ("hysteresis", "supply_voltage"),
    ("hysteresis", "warm_up"),
    ("stress_relaxation", "threshold_step"),
    ("stress_relaxation", "cross_axis"),
    ("aging", "thermal_gradient"),
    ("warm_up", "post_shock_zero_shift"),
    ("vibration_rectification", "thermal_lag"),
    ("threshold_step", "periodic_interference"),
    ("cross_axis", "aging"),
)

CONFUSABLE = (
    frozenset({"thermal_lag", "timing_offset", "thermal_gradient"}),
    frozenset({"hysteresis", "stress_relaxation"}),
)
"""Effects that programmes of two hours do not always tell apart."""

GROUPS = ("none", "single", "pairs", "unknown", "removed", "thermistor_0.05")
GENERATORS = {"project": project_sensor.runs, "other": other_sensor.runs}
UNKNOWN_OF = {"project": project_sensor.UNKNOWN, "other": tuple(UNKNOWN)}

THERMISTOR_NOISE, WORSE_NOISE = (0.02, 0.03), (0.05, 0.05)
"""°C of one sample."""

COMPANY = 0.3
"""Probability that something harmless goes on beside an effect."""


@dataclass(frozen=True)
class Item:
    """What a case is about. parts: what happens during its recordings beside what the effects need."""

    truth: tuple[str, ...] = ()
    withheld: tuple[str, ...] = ()
    parts: tuple[str, ...] = ()


@dataclass(frozen=True)
class Case:
    """Three recordings to train and to diagnose with, one to judge on.

    truth: names of the effects; for the group "unknown" a word for the structure. withheld: names that the diagnosis
    must do without. truths: what lies behind each recording, the held-out one last.
    """

    group: str
    generator: str
    truth: tuple[str, ...]
    withheld: tuple[str, ...]
    seed: int
    index: int
    training: tuple[Recording, ...]
    holdout: Recording
    truths: tuple[Truth, ...]

    @property
    def recordings(self) -> tuple[Recording, ...]:
        """All recordings, the held-out one last."""
        return *self.training, self.holdout

    @property
    def true_drift_of_effect(self) -> tuple[NDArray[np.float64], ...]:
        """What the effects add to z in each recording, (n,) m/s²."""
        return tuple(truth.effect for truth in self.truths)


def items(group: str, generator: str) -> tuple[Item, ...]:
    """Return what the cases of a group are about, in turn."""
    if group == "single":
        return tuple(Item((name,)) for name in EFFECTS)
    if group == "removed":
        return tuple(Item((name,), (name,)) for name in EFFECTS)
    if group == "pairs":
        return tuple(Item(pair) for pair in PAIRS)
    if group == "unknown":
        return tuple(Item((name,)) for name in UNKNOWN_OF[generator])
    return Item(), *(Item(parts=(part,)) for part in HARMLESS)


def make_case(group: str, index: int, seed: int, generator: str, hours: float = HOURS) -> Case:
    """Return a case, the same one for the same arguments.

    index: counts through the items of the group, again and again with other parameters. generator: "project" or
    "other". hours: length of a recording; shorter ones go through the same temperatures faster.
    """
    about = items(group, generator)
    item = about[index % len(about)]
    random = np.random.default_rng([seed, index, zlib.crc32(f"{group} {generator}".encode())])
    noise = random.uniform(*(WORSE_NOISE if group == "thermistor_0.05" else THERMISTOR_NOISE))
    plan = experiment(_parts(item, random), random, hours)
    runs = GENERATORS[generator](item.truth, plan, noise, random)
    recordings, truths = tuple(run.recording for run in runs), tuple(run.truth for run in runs)
    return Case(group, generator, item.truth, item.withheld, seed, index, recordings[:-1], recordings[-1], truths)


def _parts(item: Item, random: np.random.Generator) -> frozenset[str]:
    """Return what happens during the recordings."""
    parts = {*item.parts, *(NEEDS[name] for name in item.truth if name in NEEDS)}
    # Levels of z and motion along y are both set by the orientation.
    if item.truth and random.random() < COMPANY and "levels" not in parts:
        parts.add(str(random.choice(HARMLESS)))
    return frozenset(parts)
