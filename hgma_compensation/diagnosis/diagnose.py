"""``diagnose``: recordings and a calibration in; verdict, effects and augmented calibration out."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.calibration.document import with_id
from hgma_compensation.diagnosis.augment import augmented
from hgma_compensation.diagnosis.confirm import residue
from hgma_compensation.diagnosis.cross_validation import sweeps
from hgma_compensation.diagnosis.errors_held_out import held_out_error
from hgma_compensation.diagnosis.forward import Findings, Forward, Found
from hgma_compensation.diagnosis.prepare import acceleration_of, prepare
from hgma_compensation.diagnosis.problem import Problem, State, without_rows
from hgma_compensation.diagnosis.recordings import Material, arrange
from hgma_compensation.diagnosis.result import ChannelDiagnosis, Diagnosis, NamedEffect, named, reported_name
from hgma_compensation.diagnosis.runs import Run, make_run
from hgma_compensation.diagnosis.spectra import fit_spectra
from hgma_compensation.diagnosis.verdict import Judgement, Verdict, judge
from hgma_compensation.errors import RefusedError
from hgma_compensation.kept_memory import give_back
from hgma_compensation.recording.compensated_bag import check_covered
from hgma_compensation.recording.sliced import Sampled
from hgma_compensation.recording.spooled import Spooled
from hgma_compensation.training.blocks import FEWEST
from hgma_compensation.training.linear_algebra import one_thread
from hgma_compensation.training.train import block_length

Progress = Callable[[str, str], None]
"""Called with the channel and what is being done to it."""

SHORTEST_BLOCK = 5.0

FEWEST_SWEEPS = 4
"""Coolings and heatings that single effects need: two cycles, so that one can be left out."""


@one_thread()
def diagnose(
    recordings: Sequence[Sampled],
    calibration: Calibration,
    holdout: Sampled | None = None,
    *,
    withheld: frozenset[str] = frozenset(),
    seed: int = 1,
    progress: Progress | None = None,
) -> Diagnosis:
    """Return what the calibration leaves in the recordings, by name, judged on the hold-out.

    withheld: kinds of effects that are not tried. seed: of the surrogates. Raises RefusedError where a recording
    lacks a thermistor or a channel of the calibration, or is too short.
    """
    for recording in (*recordings, *([holdout] if holdout else [])):
        check_covered(recording, calibration)
    material = arrange(recordings, holdout)
    runs = [make_run(recording, calibration.features.noise) for recording in material.recordings]
    acceleration = tuple(acceleration_of(run, calibration) for run in runs)
    channels = []
    result = calibration
    for number, name in enumerate(calibration.names):
        random = np.random.default_rng([seed, number])
        study = _Study(material, runs, acceleration, calibration, name, withheld, random, progress)
        diagnosis, result = study.run(result)
        channels.append(diagnosis)
        give_back()
    return Diagnosis(tuple(channels), with_id(_documented(result, material, seed)), material)


@dataclass(frozen=True)
class _Study:
    """One channel."""

    material: Material
    runs: list[Run]
    acceleration: tuple[Spooled, ...]
    calibration: Calibration
    channel: str
    withheld: frozenset[str]
    random: np.random.Generator
    progress: Progress | None

    def run(self, result: Calibration) -> tuple[ChannelDiagnosis, Calibration]:
        """Return the diagnosis, and ``result`` with this channel augmented."""
        self._say("preparing")
        learned, held = self._problems()
        findings = self._search(learned)
        findings.put_away()
        carried = findings.state.problem.scene.carried
        held = replace(held, scene=replace(held.scene, carried=carried), cache={})
        self._say("judging on the hold-out")
        before = (residue(findings.before, learned), residue(findings.before, held))
        after = (residue(findings.state, findings.state.problem), residue(findings.state, held))
        judgement = judge(len(findings.found), before, after)
        before_error = held_out_error(self.material, self.runs, self.calibration, self.channel)
        after_error = before_error
        effects = tuple(named(found) for found in findings.found)
        if judgement.helped:
            candidate, _ = augmented(result, self.channel, findings.state)
            own = replace(candidate, effects=tuple(e for e in candidate.effects if e.channel == self.channel))
            tried = held_out_error(self.material, self.runs, own, self.channel)
            if tried.rms < before_error.rms:
                result, after_error = candidate, tried
            else:
                judgement = self._without_gain(effects)
        explained = judgement.verdict is Verdict.EXPLAINED
        diagnosis = ChannelDiagnosis(
            name=self.channel,
            judgement=judgement,
            effects=effects if explained else (),
            partial=effects if judgement.helped and not explained else (),
            before=before_error,
            after=after_error,
            findings=findings,
            residues_before=before,
            residues_after=after,
        )
        return diagnosis, result

    def _search(self, learned: Problem) -> Findings:
        """Return the effects one by one, or spectra of memories where nothing could be left out to validate one."""
        if sweeps(learned) >= FEWEST_SWEEPS:
            return Forward(learned, self.random, self.withheld, self._say).run()
        self._say("spectra of memories")
        before = State.of(learned, ())
        state, spectra = fit_spectra(learned, self.random, self.withheld)
        found = tuple(Found(effect, spectra.p_value, np.nan) for effect in spectra.carrying(state))
        return Findings(before, state, found, (), spectra)

    def _without_gain(self, effects: tuple[NamedEffect, ...]) -> Judgement:
        """Return the verdict on effects that do not lower the error of the calibration that was given."""
        there = {reported_name(e.effect) for e in self.calibration.effects if e.channel == self.channel}
        if effects and {effect.name for effect in effects} <= there:
            return Judgement(Verdict.NO_EFFECT, "what was found is in the calibration already", False)
        return Judgement(Verdict.UNEXPLAINED, "the effects do not lower the error on the hold-out", False)

    def _say(self, text: str) -> None:
        if self.progress is not None:
            self.progress(self.channel, text)

    def _problems(self) -> tuple[Problem, Problem]:
        """Return the problems of what is learned from and of what is held out."""
        block = block_length(self.material.recordings, SHORTEST_BLOCK)
        whole = prepare(self.runs, self.calibration, self.channel, block, self.random, self.acceleration)
        held = self.material.held_rows(whole.scene.blocks)
        for rows, what in ((~held, "to learn from"), (held, "in the hold-out")):
            if rows.sum() < FEWEST:
                names = ", ".join(recording.name for recording in self.material.recordings)
                raise RefusedError(
                    f"{names}: {rows.sum()} means of {block:g} s {what} at rest and inside the calibrated range, "
                    f"at least {FEWEST} are needed: record for longer"
                )
        return without_rows(whole, ~held), without_rows(whole, held)


def _documented(calibration: Calibration, material: Material, seed: int) -> Calibration:
    names = [recording.name for recording in material.recordings]
    note = {"diagnosis": {"recordings": names, "holdout": material.holdout, "seed": seed}}
    return replace(calibration, training={**calibration.training, **note})
