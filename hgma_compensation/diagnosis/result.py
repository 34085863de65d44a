"""What a diagnosis has to say: of each channel, and of all."""

from dataclasses import dataclass
from typing import Any

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.channels import unit_of
from hgma_compensation.diagnosis.confirm import Residue
from hgma_compensation.diagnosis.errors_held_out import HeldOutError
from hgma_compensation.diagnosis.forward import Findings, Found
from hgma_compensation.diagnosis.recordings import Material
from hgma_compensation.diagnosis.verdict import Judgement, Verdict
from hgma_compensation.effects.effect import Effect


@dataclass(frozen=True)
class NamedEffect:
    """An effect of the verdict: name as scripts know it."""

    name: str
    parameters: dict[str, Any]
    p_value: float


@dataclass(frozen=True)
class ChannelDiagnosis:
    """What was found on a channel; errors are RMS of means of 5 s of the hold-out, in the channel's unit.

    effects: those that explain the residual; partial: those that carry some of it where the verdict is unexplained.
    The rest is evidence for the report.
    """

    name: str
    judgement: Judgement
    effects: tuple[NamedEffect, ...]
    partial: tuple[NamedEffect, ...]
    before: HeldOutError
    after: HeldOutError
    findings: Findings
    residues_before: tuple[Residue, Residue]
    residues_after: tuple[Residue, Residue]

    @property
    def verdict(self) -> Verdict:
        """The verdict."""
        return self.judgement.verdict

    @property
    def undecided(self) -> tuple[str, ...]:
        """Names of effects that fit as well, but whose input never moved by itself; of noise none is said to fit."""
        rivals = [name for found in self.findings.found for name in found.undecided if self.effects or self.partial]
        left = self.findings.undecided if self.verdict is Verdict.UNEXPLAINED else ()
        return tuple(dict.fromkeys([*rivals, *left]))

    @property
    def error_before(self) -> float:
        """Error of the calibration that was given."""
        return self.before.rms

    @property
    def error_after(self) -> float:
        """Error of the augmented calibration."""
        return self.after.rms

    @property
    def noise_floor(self) -> float:
        """White noise of a mean of 5 s."""
        return self.after.noise

    def as_json(self) -> dict[str, Any]:
        """Return the figures in the form that scripts rely on."""
        return {
            "unit": unit_of(self.name),
            "verdict": self.verdict.value,
            "reason": self.judgement.reason,
            "effects": [vars(effect) for effect in self.effects],
            "partial": [vars(effect) for effect in self.partial],
            "undecided": list(self.undecided),
            "error_before": self.error_before,
            "error_after": self.error_after,
            "noise_floor": self.noise_floor,
        }


@dataclass(frozen=True)
class Diagnosis:
    """All channels, and the calibration with the effects that help."""

    channels: tuple[ChannelDiagnosis, ...]
    calibration: Calibration
    material: Material

    def as_json(self, calibration: str) -> dict[str, Any]:
        """Return the figures; calibration: path of the augmented one."""
        return {
            "channels": {channel.name: channel.as_json() for channel in self.channels},
            "calibration": calibration,
            "calibration_id": self.calibration.calibration_id,
            "holdout": self.material.holdout,
        }


def reported_name(effect: Effect) -> str:
    """Return the name that scripts know an effect by."""
    return effect.family or effect.name


def named(found: Found) -> NamedEffect:
    """Return a found effect as it is reported."""
    return NamedEffect(reported_name(found.effect), found.effect.parameters(), found.p_value)
