"""Every kind of page that there is, made of small real results with names that would break careless HTML."""

from functools import cache
from pathlib import Path

import numpy as np
from builders import make_recording
from report_diagnosis import NASTY, calibration_before, small_diagnosis

from hgma_compensation.channels import columns_of
from hgma_compensation.evaluation.evaluate import compare
from hgma_compensation.evaluation.long_evaluation import Part
from hgma_compensation.fleet.figures import BY_NAME
from hgma_compensation.fleet.limits import Limits
from hgma_compensation.fleet.options import FleetOptions
from hgma_compensation.fleet.page import fleet_page
from hgma_compensation.fleet.status import Judged, Status
from hgma_compensation.fleet.summary import summarise
from hgma_compensation.recording.compensated_bag import compensate_recording
from hgma_compensation.report.diagnosis_report import diagnosis_page
from hgma_compensation.report.evaluation_next import Evaluated
from hgma_compensation.report.evaluation_report import evaluation_page
from hgma_compensation.report.run_record import RunRecord
from hgma_compensation.report.search_record import SearchRecord
from hgma_compensation.report.training_report import training_page
from hgma_compensation.report.training_result import training_result
from hgma_compensation.training.genetic import GeneticSettings
from hgma_compensation.training.reference import Reference
from hgma_compensation.training.train import TrainingOptions, train

QUICK = TrainingOptions(
    genetic=GeneticSettings(centres=4, population=20, generations=10), delay=10.0, sensor_id=f"sensor {NASTY}"
)
CHANNELS = ("linear_acceleration.x", "linear_acceleration.z")
BAG, CALIBRATION = Path(f"some where/{NASTY}"), Path("cal's file.json")
DAY = 86_400_000_000_000


@cache
def trained():
    """Return recordings, the calibration trained on them and what the search reported."""
    recordings = [make_recording(2, 2400.0, 4.0, 1.0, cycles=2.0, channels=CHANNELS, noise=0.02, name=NASTY)]
    search = SearchRecord()
    return recordings, train(recordings, QUICK, search.add), search


@cache
def small_training():
    """Return the result of a small training."""
    recordings, calibration, search = trained()
    return training_result(recordings, calibration, QUICK.genetic, search)


def evaluated(recording, calibration, reference="mean"):
    """Return the evaluation of a recording in memory and the summary of its run."""
    result = compensate_recording(recording, calibration)
    raw = recording.values[:, columns_of(calibration.names)]
    part = Part(recording.stamps, raw, result.values, result.features[:, 0])
    record = RunRecord(len(calibration.names))
    record.add(part, result)
    evaluation = compare(part.stamps, raw, part.compensated, part.temperature, calibration, Reference.parse(reference))
    return evaluation, record.summary()


@cache
def another_day():
    """Return a recording of the sensor on the day after the training, hotter than it."""
    recording = make_recording(3, 2100.0, 4.0, 1.0, cycles=1.5, channels=CHANNELS, noise=0.02, high=68.0)
    series = recording.temperature
    return type(recording)(
        **{
            **recording.__dict__,
            "stamps": recording.stamps + DAY,
            "temperature": type(series)(series.stamps + DAY, series.values),
        }
    )


def an_evaluation_page():
    _, calibration, _ = trained()
    return evaluation_page(*evaluated(another_day(), calibration), calibration, Evaluated(BAG, CALIBRATION, "mean"))


def a_fleet_page():
    random = np.random.default_rng(8)
    limits = Limits({CHANNELS[1]: {"residual_peak_to_peak": 1.0, "velocity_random_walk": 1e3}})
    judged = Judged("sha256-0123456789abcdef", ("train",), "holdout", None, "0.0")
    statuses = [
        Status(f"sensor {number:03d}", judged, channels={name: _fleet_figures(random) for name in CHANNELS})
        for number in range(30)
    ]
    statuses.append(Status(f"sensor {NASTY}", reason=f"{NASTY} holds no thermistor sample: record /accel/temperature"))
    return fleet_page(summarise(statuses, limits, FleetOptions(QUICK)), f"Fleet {NASTY}")


def _fleet_figures(random):
    return {name: float(random.lognormal(sigma=0.6)) for name in BY_NAME}


PAGES = {
    "diagnosis": lambda: diagnosis_page(small_diagnosis(), title=f"Diagnosis {NASTY}", original=calibration_before()),
    "evaluation": an_evaluation_page,
    "fleet": a_fleet_page,
    "training": lambda: training_page(small_training(), [BAG], CALIBRATION),
}
"""HTML of each kind of page: add a page here, and it is looked at in light and dark, on a phone and on a desk."""


@cache
def html_of(name):
    """Return a page's HTML, made once."""
    return PAGES[name]()
