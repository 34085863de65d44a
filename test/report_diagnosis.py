"""A small real diagnosis that the tests of the report share, and a parser that fails on broken HTML."""

from dataclasses import replace
from functools import cache
from html.parser import HTMLParser

import numpy as np
from builders import make_recording, triangle, true_drift

from hgma_compensation.diagnosis.diagnose import diagnose
from hgma_compensation.recording.recording import Series
from hgma_compensation.report.markup import VOID
from hgma_compensation.training.methods import Method
from hgma_compensation.training.train import TrainingOptions, train

CHANNEL = "linear_acceleration.z"
NASTY = "<b>&\"'"
LASTS, RATE, LAG = 1500.0, 4.0, 40.0


def lagging_recording(name, seed, cycles):
    """Return a sensor whose drift follows the temperature late, on a day of its own."""
    recording = make_recording(
        seed, LASTS, RATE, 1.0, cycles=cycles, channels=(CHANNEL,), noise=0.5, thermistor_noise=0.01, name=name
    )
    temperature = triangle((recording.stamps - recording.stamps[0]) * 1e-9, LASTS / cycles)
    late, weight = np.empty_like(temperature), -np.expm1(-1.0 / (RATE * LAG))
    state = temperature[0]
    for k, now in enumerate(temperature.tolist()):
        state += weight * (now - state)
        late[k] = state
    values = recording.values.copy()
    values[:, 2] += true_drift(late) - true_drift(temperature)
    day = seed * 86_400_000_000_000
    thermistor = recording.temperature
    return replace(
        recording,
        values=values,
        stamps=recording.stamps + day,
        temperature=Series(thermistor.stamps + day, thermistor.values),
    )


def training_recordings():
    return [lagging_recording(NASTY, 1, 2.0), lagging_recording("second", 2, 4.0)]


@cache
def calibration_before():
    """Return a calibration that knows nothing of the lag."""
    return train(training_recordings(), TrainingOptions(method=Method.POLYNOMIAL))


@cache
def small_diagnosis():
    """Return the diagnosis of two short recordings, judged on a third one."""
    return diagnose(training_recordings(), calibration_before(), lagging_recording("held <i>out</i>", 3, 3.0))


class Checker(HTMLParser):
    """Collects tags, and fails on one that is not closed or closed in the wrong place."""

    def __init__(self, text):
        super().__init__()
        self.open, self.tags, self.links, self.text = [], [], [], []
        self.feed(text)
        self.close()
        assert not self.open

    def handle_starttag(self, tag, attributes):
        self.tags.append(tag)
        names = [name for name, _ in attributes]
        assert len(set(names)) == len(names)
        self.links += [value for name, value in attributes if name in ("src", "href", "xlink:href", "data", "action")]
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        self.handle_starttag(tag, attributes)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.text.append(data)


def words(text):
    """Return the text of a page."""
    return " ".join(" ".join(Checker(text).text).split())
