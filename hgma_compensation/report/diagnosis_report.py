"""``report.html`` of ``hgma diagnose``."""

from pathlib import Path

from hgma_compensation import __version__
from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.diagnosis.result import Diagnosis
from hgma_compensation.files import write_atomically
from hgma_compensation.kept_memory import give_back
from hgma_compensation.report import tables
from hgma_compensation.report.channel_section import channel_section
from hgma_compensation.report.markup import Html, element, inner
from hgma_compensation.report.page import page, section

LIMITS = (
    "A name stands for the best of a catalogue, not for a proof: an effect that is not in it, but alike, would be "
    "given the nearest name. Nothing is said about temperatures and rates outside of those recorded, nor about effects "
    "that these recordings could not set off. The errors hold for the hold-out; another day may differ."
)


def write_diagnosis_report(
    diagnosis: Diagnosis, path: Path, *, title: str, original: Calibration | None = None
) -> None:
    """Write the report as one page that needs no network; it appears whole or not at all.

    original: the calibration that was diagnosed, which the augmented one is compared with. Raises RefusedError where
    the page cannot be written.
    """
    write_atomically(path, diagnosis_page(diagnosis, title=title, original=original).encode())


def diagnosis_page(diagnosis: Diagnosis, *, title: str, original: Calibration | None = None) -> str:
    """Return the report as HTML."""
    channels = []
    for index in range(len(diagnosis.channels)):
        channels.append(channel_section(diagnosis, index, original))
        give_back()  # what the figures took
    overview = [section("All channels", tables.overview(diagnosis), level=2)] if len(channels) > 1 else []
    return page(title, _head(diagnosis, title, original), *overview, *channels, _judged(diagnosis))


def _head(diagnosis: Diagnosis, title: str, original: Calibration | None) -> Html:
    new = element("code", diagnosis.calibration.calibration_id)
    ids = inner("Augmented calibration ", new)
    if original is not None:
        ids = inner("Calibration ", element("code", original.calibration_id), " → ", new)
    about = f"Sensor {diagnosis.calibration.sensor_id}, judged on “{diagnosis.material.holdout}”."
    return element("header", element("h1", title), element("p", about), element("p", ids))


def _judged(diagnosis: Diagnosis) -> Html:
    seed = diagnosis.calibration.training.get("diagnosis", {}).get("seed", "unknown")
    how = (
        "The effects were looked for in the recordings below, means over blocks, under a noise model of white noise, "
        "flicker and the thermistor’s error; p-values say how often noise alone does as well over all that was tried. "
        "The errors before and after were measured on the hold-out, to which nothing was fitted."
    )
    made = f"Seed {seed}. Made by hgma_compensation {__version__}."
    return element(
        "article",
        section(
            "How it was judged",
            element("p", how),
            tables.recordings(diagnosis),
            *(tables.noise(channel) for channel in diagnosis.channels),
            element("h3", "Limits"),
            element("p", LIMITS),
            element("p", made, class_="quiet"),
            level=2,
        ),
        class_="channel",
    )
