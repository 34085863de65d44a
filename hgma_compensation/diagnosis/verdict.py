"""From numbers to one of three words."""

from dataclasses import dataclass
from enum import Enum
from math import sqrt

from hgma_compensation.diagnosis.confirm import Residue


class Verdict(str, Enum):
    """EXPLAINED: effects of the catalogue carry the residual. NO_EFFECT: it is noise. UNEXPLAINED: neither."""

    EXPLAINED = "explained"
    NO_EFFECT = "no_effect"
    UNEXPLAINED = "unexplained"


RARE = 1e-4
"""Probability on noise below which structure is real."""

MATTERS = 0.4
"""Structure, RMS over the noise of a mean of 10 s, below which it is none of the user's concern."""

CARRIED = 0.25
"""RMS that effects may leave over that which they carry: the true law is never quite the fitted one."""


@dataclass(frozen=True)
class Judgement:
    """The verdict and why, in words. helped: whether effects that do not explain all still predict the hold-out."""

    verdict: Verdict
    reason: str
    helped: bool


def judge(found: int, before: tuple[Residue, Residue], after: tuple[Residue, Residue]) -> Judgement:
    """Return the verdict on residues (learned from, held out), of the drift model alone and with the effects found."""
    better = after[1].energy < after[1].energy_of(before[1].residual)
    helped = bool(found) and better and _mean_square(after[1]) < _mean_square(before[1])
    # Where nothing was found, what is left is what was there before, judged without the spread of what was tried.
    left_over = after if found else before
    structure = [
        name for name, one in zip(("the recordings", "the hold-out"), left_over, strict=True) if has_structure(one)
    ]
    if not found:
        if structure:
            return Judgement(Verdict.UNEXPLAINED, f"structure in {' and '.join(structure)} that nothing carries", False)
        return Judgement(Verdict.NO_EFFECT, "what is left is noise", False)
    if not helped:
        if has_structure(before[0]) or has_structure(before[1]):
            return Judgement(Verdict.UNEXPLAINED, "what was found does not hold on the hold-out", False)
        return Judgement(Verdict.NO_EFFECT, "what was found does not hold on the hold-out, and it is small", False)
    left = [a.slow.excess > CARRIED * _carried(b, a) for a, b in zip(after, before, strict=True)]
    if structure and any(left[i] and has_structure(after[i]) for i in (0, 1)):
        return Judgement(Verdict.UNEXPLAINED, f"structure in {' and '.join(structure)} is left", True)
    return Judgement(Verdict.EXPLAINED, "the effects predict the hold-out", True)


def has_structure(residue: Residue) -> bool:
    """Return whether a residue holds more than noise, and enough of it to matter."""
    slow = residue.slow
    return (slow.p_value < RARE and slow.excess > MATTERS * residue.noise) or residue.line_p_value < RARE


def _carried(before: Residue, after: Residue) -> float:
    """Return the RMS of what effects carry of a residue, in the channel's unit."""
    return sqrt(max(_mean_square(before) - _mean_square(after), 0.0))


def _mean_square(residue: Residue) -> float:
    return float((residue.residual**2).mean())
