from itertools import count

import pytest
from builders import LINEAR, make_calibration
from effect_calibrations import calibrations
from hypothesis import given, settings
from hypothesis import strategies as st
from live_events import EVENTS, outputs

from hgma_compensation.calibration.document import read_calibration, write_calibration
from hgma_compensation.errors import RefusedError
from hgma_compensation.loading.job import Request
from hgma_compensation.loading.process import LoadingProcess
from hgma_compensation.pipeline.live import LiveCompensation
from hgma_compensation.pipeline.prepared import Prepared


def request(path, live, directory=None):
    return Request(path, directory, "", live.histories())


def nothing():
    """Serve nothing."""


@pytest.fixture(scope="module")
def shared():
    made = LoadingProcess()
    yield made
    made.close()


@pytest.fixture(scope="module")
def places(tmp_path_factory):
    directory = tmp_path_factory.mktemp("calibrations")
    return (directory / f"{number}.json" for number in count())


@settings(max_examples=20)
@given(calibrations(), st.integers(0, len(EVENTS) - 1), st.integers(0, 60))
def test_what_another_process_prepared_is_bit_for_bit_what_was_installed(shared, places, calibration, begin, taking):
    away, directly, path = LiveCompensation(), LiveCompensation(), next(places)
    write_calibration(calibration, path)
    for live in (away, directly):
        live.install(make_calibration(seed=7, channels=LINEAR))
        outputs(live, EVENTS[:begin])
    asked = request(path, away)
    prepared = Prepared(shared.ask(asked, nothing), asked.histories)
    for live in (away, directly):
        outputs(live, EVENTS[begin : begin + taking])
    away.adopt(prepared)
    directly.install(read_calibration(path))
    rest = EVENTS[begin + taking :][:200]
    assert outputs(away, rest) == outputs(directly, rest)
    assert away.snapshot().pipeline == directly.snapshot().pipeline


def test_a_refusal_is_the_one_that_reading_gives(shared, calibration_file, tmp_path):
    (tmp_path / "cut.json").write_bytes(calibration_file.read_bytes()[:100])
    for path in (tmp_path / "cut.json", tmp_path / "missing.json", tmp_path, tmp_path / ("long" * 100)):
        with pytest.raises(RefusedError) as expected:
            read_calibration(path)
        with pytest.raises(RefusedError) as refused:
            shared.ask(request(path, LiveCompensation()), nothing)
        assert str(refused.value) == str(expected.value)
    (tmp_path / "inside").mkdir()
    with pytest.raises(RefusedError, match="outside of the calibration directory"):
        shared.ask(request(calibration_file, LiveCompensation(), directory=tmp_path / "inside"), nothing)
