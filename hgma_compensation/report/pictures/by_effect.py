"""Which pictures show the evidence for which kind of effect."""

import gc
from collections.abc import Callable, Iterator

from hgma_compensation.diagnosis.forward import Findings
from hgma_compensation.kept_memory import give_back
from hgma_compensation.report.pictures import against, in_time, memory, spectrum
from hgma_compensation.report.pictures.canvas import Chart
from hgma_compensation.report.pictures.evidence import Evidence, evidence_of

Pictures = Callable[[Evidence], list[Chart]]

PICTURES: dict[str, tuple[Pictures, ...]] = {
    "thermal_lag": (memory.corner_response, memory.loop),
    "timing_offset": (memory.corner_response, memory.loop),
    "hysteresis": (memory.loop,),
    "rate_dependent_hysteresis": (memory.loop,),
    "stress_relaxation": (memory.soak_response, memory.loop),
    "warm_up": (in_time.after_power_on, in_time.over_recordings),
    "aging": (in_time.over_age,),
    "post_shock_zero_shift": (in_time.after_shocks,),
    "thermal_gradient": (against.against_gradient, in_time.over_recordings),
    "supply_voltage": (against.against_voltage, in_time.over_recordings),
    "cross_axis": (against.against_axis, in_time.over_recordings),
    "scale_factor_temperature": (against.scale_factor, against.against_input),
    "quadratic_nonlinearity": (against.against_input, in_time.over_recordings),
    "vibration_rectification": (against.against_vibration, in_time.over_recordings),
    "threshold_step": (against.against_threshold, in_time.over_recordings),
    "periodic_interference": (spectrum.folded,),
}
"""By the name of the kind; one that is not here is drawn over time."""


def evidence_charts(findings: Findings, channel: str) -> Iterator[tuple[str, list[Chart]]]:
    """Yield the title of each effect that was found, with its charts."""
    for evidence in evidence_of(findings, channel):
        gc.collect()  # what was drawn before: figures refer to themselves, and there are several for each effect
        give_back()
        pictures = PICTURES.get(evidence.effect.name, (in_time.over_recordings,))
        charts = [chart for picture in pictures for chart in picture(evidence)]
        if evidence.effect.name == "periodic_interference":
            charts += spectrum.spectrum(findings)
        give_back()  # what fits and the recordings' temperatures took
        yield evidence.effect.title, charts or in_time.over_recordings(evidence)
