import json
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from builders import LINEAR, make_calibration, make_recording
from report_diagnosis import NASTY, Checker, words
from report_pages import BAG, CALIBRATION, another_day, evaluated, html_of, trained

from hgma_compensation.calibration.document import write_calibration
from hgma_compensation.cli.main import main
from hgma_compensation.evaluation.allan import allan_curve
from hgma_compensation.evaluation.long_evaluation import Part
from hgma_compensation.pipeline.status import TemperatureStatus
from hgma_compensation.recording.bag_writer import write_recording
from hgma_compensation.recording.compensated_bag import compensate_recording
from hgma_compensation.report import evaluation_sentences as sentences
from hgma_compensation.report.evaluation_next import Evaluated, next_step
from hgma_compensation.report.evaluation_report import evaluation_page
from hgma_compensation.report.markup import element
from hgma_compensation.report.pictures.decimate import MOST, extremes
from hgma_compensation.report.pictures.errors import rates
from hgma_compensation.report.run_record import AT_ONCE, RunRecord
from hgma_compensation.report.trained_on import TrainedOn, trained_on


@pytest.fixture(scope="module")
def evaluation():
    _, calibration, _ = trained()
    return evaluated(another_day(), calibration)


def page_of(recording, calibration, reference="mean"):
    return evaluation_page(
        *evaluated(recording, calibration, reference), calibration, Evaluated(BAG, CALIBRATION, reference)
    )


def test_page_is_well_formed_and_needs_nothing_but_itself():
    checked = Checker(html_of("evaluation"))
    assert checked.tags.count("svg") == 2 * 7
    assert not {"script", "link", "img", "iframe"} & set(checked.tags)
    assert all(link.startswith("#") for link in checked.links)
    assert not [word for word in ("@import", "http:", "https:", "<b>", NASTY) if word in html_of("evaluation")]


def test_page_says_how_large_the_error_is_and_where(evaluation):
    text = words(html_of("evaluation"))
    result, summary = evaluation
    z = result.channels[1]
    assert f"Evaluation of {NASTY}" in text
    assert result.calibration_id in text
    worst = sentences.worst(z)
    assert z.compensated_error.min() <= worst.error <= z.compensated_error.max()
    assert f"at {worst.temperature:.1f} °C while heating" in text.replace("\u00a0", " ")
    assert "nothing was fitted to it" in text
    assert f"{summary.samples} (4.00 Hz)" in text


def test_summary_counts_what_the_pipeline_says():
    _, calibration, _ = trained()
    recording = another_day()
    result = compensate_recording(recording, calibration)
    _, summary = evaluated(recording, calibration)
    assert summary.outside == np.count_nonzero(~result.inside_range) > 0
    assert sum(summary.statuses.values()) == summary.samples == len(recording.stamps)
    assert summary.statuses[TemperatureStatus.SETTLING] == np.count_nonzero(result.status == TemperatureStatus.SETTLING)
    assert summary.duration == pytest.approx(recording.duration)
    assert summary.interval == pytest.approx(0.25)


def test_summary_does_not_depend_on_how_the_samples_come():
    count, random = 2 * AT_ONCE + 1000, np.random.default_rng(4)
    stamps = np.arange(1, count + 1) * 10_000_000
    raw, compensated = random.standard_normal((2, count, 1)).cumsum(axis=1)

    class Result:
        status = np.arange(count) % 5 // 4
        inside_range = np.arange(count) % 3 > 0

    def gathered(edges):
        record = RunRecord(1)
        for start, stop in pairwise(edges):
            part = Result()
            part.status, part.inside_range = Result.status[start:stop], Result.inside_range[start:stop]
            rows = slice(start, stop)
            record.add(Part(stamps[rows], raw[rows], compensated[rows], raw[rows, 0]), part)
        return record.summary()

    whole, parts = gathered([0, count]), gathered([0, 7, 1000, 70_000, 70_001, count])
    assert replace(whole, curves=()) == replace(parts, curves=())
    assert whole.outside == -(-count // 3)
    for one, other in zip(whole.curves[0], parts.curves[0], strict=True):
        np.testing.assert_array_equal(one.taus, other.taus)
        np.testing.assert_allclose(one.deviations, other.deviations, rtol=1e-9)
    exact = allan_curve(stamps, raw[:, 0])
    np.testing.assert_allclose(whole.curves[0][0].deviations[:3], exact.deviations[:3], rtol=1e-9)


def test_a_recording_that_was_trained_on_is_called_so():
    recordings, calibration, _ = trained()
    own = recordings[0]
    start, end = int(own.stamps[0]), int(own.stamps[-1])
    assert trained_on(calibration, own.name, start, end).certain
    assert trained_on(calibration, own.name, start + 10**9, end - 10**9).certain
    copy = trained_on(calibration, "copy", start, end)
    assert not copy.certain
    assert "overlap" in copy.said
    later = trained_on(calibration, own.name, end + 10**9, end + 10**10)
    assert not later.certain
    assert "nothing was fitted to it" in later.said
    diagnosed = replace(calibration, training={**calibration.training, "diagnosis": {"recordings": ["new"]}})
    assert trained_on(diagnosed, "new", end + 10**9, end + 10**10).certain
    unknown = replace(calibration, training={})
    assert "does not say" in trained_on(unknown, own.name, start, end).said
    page = evaluation_page(*evaluated(own, calibration), calibration, Evaluated(BAG, CALIBRATION, "mean"))
    assert "was trained on this recording" in words(page)


def test_verdicts_tell_noise_from_drift_from_harm(evaluation):
    channel = evaluation[0].channels[0]

    def judged(error, floor=1.0):
        measures = replace(channel.compensated, rms_error=error)
        return replace(channel, compensated=measures, raw=replace(channel.raw, rms_error=5.0), noise_floor=floor)

    assert [sentences.kind(judged(error)) for error in (0.9, 1.4, 1.6, 4.9, 5.1)] == [
        "good",
        "good",
        "calm",
        "calm",
        "bad",
    ]
    assert "no more than the noise" in sentences.headline(judged(0.9))
    assert "2.0\u00a0× the noise" in sentences.headline(judged(2.0))
    assert "makes the error larger" in sentences.headline(judged(6.0))
    assert sentences.headline(judged(2.0, floor=0.0)).endswith("2.50 times smaller.")


def test_what_to_do_next_follows_from_what_was_found(evaluation):
    (channel, *_), summary = evaluation[0].channels, evaluation[1]
    about, seen, unseen = Evaluated(Path("a bag"), Path("cal.json"), "mean"), TrainedOn(True, ""), TrainedOn(False, "")

    def told(error, known=unseen, outside=0):
        measures = replace(channel.compensated, rms_error=error)
        judged = replace(channel, compensated=measures, raw=replace(channel.raw, rms_error=5.0), noise_floor=1.0)
        return words(element("p", *next_step(judged, replace(summary, outside=outside), about, known)))

    assert "hgma node --ros-args -p calibration_file:=cal.json" in told(1.0)
    assert "hgma evaluate ANOTHER_BAG" in told(1.0, seen)
    assert "hgma diagnose 'a bag' --calibration cal.json -o diagnosis" in told(3.0, seen)
    assert "hgma train ANOTHER_BAG 'a bag'" in told(3.0, outside=summary.samples)
    assert "hgma inspect cal.json" in told(6.0)


def test_an_offset_is_called_one(evaluation):
    channel = evaluation[0].channels[0]
    off = replace(
        channel,
        compensated_error=np.full(len(channel.time), 3.0),
        compensated=replace(channel.compensated, rms_error=3.0),
        noise_floor=0.1,
    )
    assert "constant offset of 3.00" in sentences.remarks(off)[1]


def test_share_never_says_none_or_all_where_it_is_not():
    assert [sentences.share(count, 10**6) for count in (0, 1, 50_000, 10**6 - 1, 10**6)] == [
        "none",
        "less than 0.1\u00a0%",
        "5.00\u00a0%",
        "99.9\u00a0%",
        "all",
    ]


def test_rate_is_that_of_the_ramp():
    time = np.arange(2.5, 600.0, 5.0)
    temperature = np.interp(time, [0.0, 300.0, 600.0], [0.0, 30.0, 0.0])
    found = rates(time, temperature)
    assert np.allclose(found[time < 260.0], 0.1)
    assert np.allclose(found[time > 340.0], -0.1)
    assert rates(np.array([2.5]), np.array([20.0])).tolist() == [0.0]


def test_long_series_keep_their_peaks():
    values = np.random.default_rng(1).standard_normal(100_000)
    values[[17, 54_321]] = 50.0, -60.0
    values[99_999] = np.nan
    rows = extremes(values)
    assert len(rows) <= MOST
    assert {17, 54_321} <= set(rows.tolist())
    assert np.all(np.diff(rows) > 0)
    assert np.isfinite(values[rows]).all()
    assert extremes(values[:MOST]).tolist() == list(range(MOST))


@pytest.mark.parametrize("seconds", [4.0, 12.0])
def test_a_recording_of_a_few_seconds_has_a_page(seconds):
    text = words(page_of(make_recording(duration_s=seconds, cycles=1.0), make_calibration(channels=LINEAR[:1])))
    assert "nan" not in text
    assert "inf " not in text
    assert "Largest over a minute" in text


def test_size_is_bounded_for_a_long_recording_of_all_channels():
    calibration = make_calibration(channels=LINEAR)
    result, summary = evaluated(make_recording(duration_s=100.0, cycles=1.0), calibration)
    random = np.random.default_rng(1)
    count = 50_000  # means of 5 s: three days
    time = np.arange(count) * 5.0
    long = tuple(
        replace(
            channel,
            time=time,
            temperature=25.0 + 35.0 * np.sin(time / 5000.0),
            raw_error=random.standard_normal(count) * 1e4,
            compensated_error=random.standard_normal(count),
        )
        for channel in (*result.channels, *result.channels)
    )
    six = replace(calibration, channels=(*calibration.channels, *calibration.channels))
    summary = replace(summary, curves=(*summary.curves, *summary.curves))
    html = evaluation_page(replace(result, channels=long), summary, six, Evaluated(BAG, CALIBRATION, "mean"))
    assert 300_000 < len(html.encode()) < 1_500_000


@pytest.fixture
def files(tmp_path):
    _, calibration, _ = trained()
    write_recording(another_day(), tmp_path / "bag")
    write_calibration(calibration, tmp_path / "cal.json")
    return tmp_path


def run(*arguments):
    return main([str(argument) for argument in arguments])


def test_command_writes_the_page_and_nothing_else_changes(files, capsys):
    arguments = ("evaluate", files / "bag", "--calibration", files / "cal.json", "--json")
    assert run(*arguments, files / "without.json") == 0
    assert run(*arguments, files / "with.json", "--report", files / "page.html") == 0
    assert (files / "with.json").read_bytes() == (files / "without.json").read_bytes()
    text = words((files / "page.html").read_text(encoding="utf-8"))
    rms = json.loads((files / "with.json").read_text())["channels"]["linear_acceleration.z"]["raw"]["rms_error"]
    assert f"falls from {rms:.2f}" in text.replace("\u00a0", " ")
    assert "page.html: report" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("name", "said"),
    [("cal.json", "such as cal.html"), ("nowhere/page.html", "no directory"), ("folder.html", "is a directory")],
)
def test_a_page_that_cannot_be_is_refused_before_any_work(files, capsys, name, said):
    (files / "folder.html").mkdir()
    before = (files / "cal.json").read_bytes()
    assert run("evaluate", files / "no bag", "--calibration", files / "cal.json", "--report", files / name) == 2
    captured = capsys.readouterr()
    assert said in captured.err
    assert captured.err.count("\n") == 1
    assert (files / "cal.json").read_bytes() == before
