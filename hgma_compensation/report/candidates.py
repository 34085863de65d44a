"""Tables of what was tried."""

from hgma_compensation.diagnosis.forward import Candidate
from hgma_compensation.diagnosis.result import ChannelDiagnosis
from hgma_compensation.diagnosis.spectra import Family, Spectra
from hgma_compensation.effects.thermal_lag import ThermalLag
from hgma_compensation.report.markup import Html, details, element, inner, table
from hgma_compensation.report.words import number, plain_name, probability, quantity, title_of

CANDIDATE = ("candidate", "gain", "BIC", "p-value", "folds predicted", "contribution / noise", "what became of it")


def families(spectra: Spectra, channel: str) -> Html:
    """Return the families of memories that were compared where single effects could not be."""
    shares = {id(family): share for share, family in spectra.shares}
    best = spectra.families[0].posterior.log_evidence
    rows = []
    for family in spectra.families:
        knows = not family.effects or family.deviation < spectra.static
        share = shares.get(id(family), 0.0)
        fate = "less evidence than the one taken" if knows else "does not know what the sweep back would do"
        if family is spectra.chosen:
            fate = "taken"
        elif share:
            fate = "takes part in the average"
        rows.append(
            [
                element("strong", _family(family)) if family is spectra.chosen else _family(family),
                number(family.posterior.log_evidence - best) if family.posterior.log_evidence < best else "best",
                f"{round(100.0 * share)} %" if share else "–",
                quantity(family.deviation, channel),
                fate,
            ]
        )
    heads = ("family of memories", "ln evidence", "share", "uncertainty of the sweep back", "what became of it")
    said = (
        "With fewer than two cycles nothing can be left out to validate a single effect. Families of memories were "
        f"compared by their evidence instead; p-value of the memories on noise: {probability(spectra.p_value)}."
    )
    return inner(element("p", said), table(heads, rows, numbers=(1, 2, 3)))


def _family(family: Family) -> str:
    bends = [int(effect.centres) for effect in family.effects if isinstance(effect, ThermalLag) and effect.centres]
    return plain_name(family.title) + (f" ({bends[0]} Gaussians)" if bends else "")


def stages(channel: ChannelDiagnosis) -> Html:
    """Return the candidates of each stage of the search."""
    if channel.findings.spectra is not None:
        return families(channel.findings.spectra, channel.name)
    parts = []
    for number_, candidates in enumerate(channel.findings.stages, start=1):
        chosen = next((c for c in candidates if not c.reason), None)
        rows = [_candidate(c, candidates[0], chosen, channel) for c in candidates]
        result = f"taken: {title_of(chosen.scored.name)}" if chosen else "none taken"
        summary = f"Stage {number_}: {len(candidates)} candidates, {result}"
        parts.append(details(summary, table(CANDIDATE, rows, numbers=(1, 2, 3, 4, 5)), open_=number_ == 1))
    legend = (
        "Gain: fall of the whitened energy. BIC: over the best candidate of the stage, less is better. Folds: share of "
        "the parts of the recordings that the candidate predicts without having seen them. Contribution: RMS of what "
        "no drift model could carry, over the noise of a mean of 10 s. Both only where the p-value is small."
    )
    return inner(*parts, element("p", legend, class_="quiet"))


def _candidate(one: Candidate, best: Candidate, chosen: Candidate | None, channel: ChannelDiagnosis) -> list[str]:
    scored = one.scored
    tried = one.folds > 0.0 or one.contribution > 0.0
    return [
        element("strong", title_of(scored.name)) if one is chosen else title_of(scored.name),
        number(scored.gain),
        "best" if one is best else f"+{number(scored.bic - best.scored.bic)}",
        probability(one.p_value),
        f"{round(100.0 * one.folds)} %" if tried else "–",
        number(one.contribution, 2) if tried else "–",
        one.reason or _fate(one, chosen, channel),
    ]


def _fate(one: Candidate, chosen: Candidate | None, channel: ChannelDiagnosis) -> str:
    if one is not chosen:
        return "fits less well than the one taken"
    kept = any(found.effect.name == one.scored.name for found in channel.findings.found)
    return "taken" if kept else "taken, later replaced or dropped"
