"""What a diagnosis made of the cases, in numbers."""

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from benchmarks.loop.cases import CONFUSABLE

EFFECT_FREE = ("none", "thermistor_0.05")
EXPLAINED, NO_EFFECT, UNEXPLAINED = "explained", "no_effect", "unexplained"


@dataclass(frozen=True)
class Outcome:
    """One case. size: of what is to be found, over the noise floor.

    verdict and named as diagnosed, the first named effect first; "" and nothing where it failed.
    claimed_before, claimed_after, noise_floor: as the diagnosis states them. before, after: errors against the truth
    of the calibrations without and with the diagnosis. oracle: of one that knew the effects. best: of a perfect
    drift model. All are RMS in m/s² over means of 5 s of the held-out recording. failure: why there is no result.
    """

    group: str
    generator: str
    truth: tuple[str, ...]
    index: int
    seed: int
    size: float = np.nan
    verdict: str = ""
    named: tuple[str, ...] = ()
    parameters: tuple[dict[str, Any], ...] = ()
    p_values: tuple[float, ...] = ()
    claimed_before: float = np.nan
    claimed_after: float = np.nan
    noise_floor: float = np.nan
    before: float = np.nan
    after: float = np.nan
    oracle: float = np.nan
    best: float = np.nan
    seconds: float = np.nan
    failure: str = ""


@dataclass(frozen=True)
class Ratios:
    """Median and 90th percentile; None where there is nothing."""

    median: float | None
    ninety: float | None

    @classmethod
    def of(cls, values: Iterable[float]) -> "Ratios":
        """Return those of the finite values."""
        finite = [value for value in values if np.isfinite(value)]
        return cls(float(np.median(finite)), float(np.quantile(finite, 0.9))) if finite else cls(None, None)


@dataclass(frozen=True)
class Summary:
    """Counts of one group and generator, of those that gave a result.

    right_name, right_class: first named effect, of the cases that have one in the catalogue. exact: all of the true
    names and no other. unexplained: of those with an effect, or structure, that was not to be named.
    """

    cases: int
    failures: int
    named: int
    right_name: int
    right_class: int
    exact: int
    unexplained: int
    after_over_before: Ratios
    after_over_oracle: Ratios
    after_over_best: Ratios
    seconds: Ratios = field(default_factory=lambda: Ratios(None, None))


def class_of(name: str) -> frozenset[str]:
    """Return the names that cannot be told from this one, itself among them."""
    return next((one for one in CONFUSABLE if name in one), frozenset({name}))


def right_name(truth: Sequence[str], named: Sequence[str]) -> bool:
    """Return whether the first named effect is there; where there is none, whether none is named."""
    return named[0] in truth if named else not truth


def right_class(truth: Sequence[str], named: Sequence[str]) -> bool:
    """Return whether the first named effect cannot be told from one that is there."""
    return any(named[0] in class_of(name) for name in truth) if named else not truth


def exact(truth: Sequence[str], named: Sequence[str]) -> bool:
    """Return whether all that is there is named, and nothing else."""
    return sorted(set(truth)) == sorted(named)


def first_said(outcome: Outcome) -> str:
    """Return the first named effect, the verdict where none is named, "failed" where there is no result."""
    if outcome.failure:
        return "failed"
    return outcome.named[0] if outcome.named else outcome.verdict


def confusion(outcomes: Iterable[Outcome]) -> dict[str, Counter[str]]:
    """Return for each truth (pairs joined by "+", "none" for nothing) how often what was said first."""
    table: dict[str, Counter[str]] = {}
    for outcome in outcomes:
        table.setdefault("+".join(outcome.truth) or "none", Counter())[first_said(outcome)] += 1
    return table


def false_alarm_rate(outcomes: Iterable[Outcome]) -> float | None:
    """Return the share of effect-free cases in which an effect is named; None without such cases."""
    free = [bool(o.named) for o in outcomes if o.group in EFFECT_FREE and not o.failure]
    return sum(free) / len(free) if free else None


def summarise(outcomes: Sequence[Outcome]) -> Summary:
    """Return the counts and ratios of outcomes, of one group as a rule."""
    done = [outcome for outcome in outcomes if not outcome.failure]
    return Summary(
        cases=len(outcomes),
        failures=len(outcomes) - len(done),
        named=sum(bool(o.named) for o in done),
        right_name=sum(right_name(o.truth, o.named) for o in done),
        right_class=sum(right_class(o.truth, o.named) for o in done),
        exact=sum(exact(o.truth, o.named) for o in done),
        unexplained=sum(o.verdict == UNEXPLAINED for o in done),
        after_over_before=Ratios.of(o.after / o.before for o in done),
        after_over_oracle=Ratios.of(o.after / o.oracle for o in done),
        after_over_best=Ratios.of(o.after / o.best for o in done),
        seconds=Ratios.of(o.seconds for o in done),
    )
