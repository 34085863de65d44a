from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest

from hgma_compensation.diagnosis.verdict import CARRIED, MATTERS, RARE, Verdict, has_structure, judge


@dataclass(frozen=True)
class Made:
    """A residue of 50 blocks with noise of 1. size: RMS of its structure."""

    size: float
    p_value: float = 0.5
    line_p_value: float = 1.0
    noise: float = 1.0
    dull: float = 1.0

    @property
    def residual(self):
        return np.full(50, np.hypot(self.size, 1.0))

    def energy_of(self, residual):
        """Energy under noise that is wider where little is known."""
        return float(np.mean(residual**2)) / self.dull

    @property
    def energy(self):
        return self.energy_of(self.residual)

    @property
    def slow(self):
        return SimpleNamespace(p_value=self.p_value, excess=self.size)


NOISE = Made(0.05)
STRUCTURE = Made(5.0, p_value=1e-9)


def verdict(found, before, after):
    judgement = judge(found, before, after)
    assert judgement.reason
    return judgement.verdict, judgement.helped


def test_noise_is_no_effect():
    assert verdict(0, (NOISE, NOISE), (NOISE, NOISE)) == (Verdict.NO_EFFECT, False)


@pytest.mark.parametrize("pair", [(STRUCTURE, NOISE), (NOISE, STRUCTURE), (STRUCTURE, STRUCTURE)])
def test_structure_that_nothing_carries_is_unexplained_and_said_where(pair):
    judgement = judge(0, pair, pair)
    assert judgement.verdict is Verdict.UNEXPLAINED
    assert ("the recordings" in judgement.reason) == (pair[0] is STRUCTURE)
    assert ("the hold-out" in judgement.reason) == (pair[1] is STRUCTURE)


def test_effects_that_carry_all_of_it_explain_it():
    assert verdict(1, (STRUCTURE, STRUCTURE), (NOISE, NOISE)) == (Verdict.EXPLAINED, True)


@pytest.mark.parametrize("place", [0, 1])
def test_effects_that_leave_a_large_part_help_but_do_not_explain(place):
    left = Made(2.0 * CARRIED * STRUCTURE.size, p_value=1e-9)
    after = [NOISE, NOISE]
    after[place] = left
    assert verdict(1, (STRUCTURE, STRUCTURE), tuple(after)) == (Verdict.UNEXPLAINED, True)


def test_a_small_part_may_be_left():
    left = Made(0.5 * CARRIED * STRUCTURE.size, p_value=1e-9)
    assert has_structure(left)
    assert verdict(1, (STRUCTURE, STRUCTURE), (left, left)) == (Verdict.EXPLAINED, True)


def test_effects_that_make_the_hold_out_worse_are_not_believed():
    worse = Made(7.0, p_value=1e-9)
    assert verdict(1, (STRUCTURE, STRUCTURE), (NOISE, worse)) == (Verdict.UNEXPLAINED, False)
    assert verdict(1, (NOISE, NOISE), (NOISE, Made(0.06))) == (Verdict.NO_EFFECT, False)


def test_an_energy_that_falls_only_by_doubt_is_no_help():
    doubtful = Made(6.0, p_value=0.3, dull=100.0)
    assert doubtful.energy < STRUCTURE.energy
    assert verdict(1, (STRUCTURE, STRUCTURE), (NOISE, doubtful)) == (Verdict.UNEXPLAINED, False)


@pytest.mark.parametrize(
    ("residue", "expected"),
    [
        (Made(2.0 * MATTERS, p_value=0.1 * RARE), True),
        (Made(0.5 * MATTERS, p_value=0.1 * RARE), False),
        (Made(2.0 * MATTERS, p_value=10.0 * RARE), False),
        (Made(0.0, line_p_value=0.1 * RARE), True),
        (Made(0.0, line_p_value=10.0 * RARE), False),
    ],
)
def test_structure_is_rare_and_large_enough_to_matter_or_a_line(residue, expected):
    assert has_structure(residue) is expected
