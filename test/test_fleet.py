"""A fleet calibrated, resumed, judged; what is wrong with one sensor stays its own affair."""

import csv
import json
import multiprocessing
import os
import shutil
import signal
import subprocess
import sys
import time
from dataclasses import replace

import pytest
from cli_runs import refused, run
from fleet_folders import (
    OPTIONS,
    QUICK,
    Z,
    contents,
    die_on_s01,
    die_once_on_s01,
    finished_in,
    run_fleet,
    small,
    write_small_fleet,
    write_small_sensor,
)
from refusals import refusal_of
from report_diagnosis import Checker, words

from hgma_compensation.calibration.document import read_calibration
from hgma_compensation.evaluation.evaluate import compare
from hgma_compensation.fleet import job as job_module
from hgma_compensation.fleet.limits import Limits
from hgma_compensation.fleet.local_engine import run_here
from hgma_compensation.fleet.options import FleetOptions
from hgma_compensation.fleet.page import fleet_page
from hgma_compensation.fleet.run import jobs_of, run_jobs
from hgma_compensation.fleet.summary import State, summarise
from hgma_compensation.fleet.table import summary_csv
from hgma_compensation.recording.bag_reader import read_recording
from hgma_compensation.recording.bag_writer import write_recording
from hgma_compensation.recording.compensated_bag import compensate_recording
from hgma_compensation.topics import TopicNames
from hgma_compensation.training.reference import Reference


@pytest.fixture(scope="module")
def fleet(tmp_path_factory):
    """A fleet of four, the last one without a thermistor; not to be changed."""
    return write_small_fleet(tmp_path_factory.mktemp("fleet") / "sensors", 4)


@pytest.fixture(scope="module")
def calibrated(fleet, tmp_path_factory):
    """The same fleet calibrated; not to be changed."""
    output = tmp_path_factory.mktemp("fleet") / "calibrated"
    return output, run_fleet(fleet, output)


def test_each_sensor_is_what_train_and_evaluate_would_have_written(fleet, calibrated, tmp_path):
    output, statuses = calibrated
    assert [status.calibrated for status in statuses] == [True, True, True, False]
    cal, figures = tmp_path / "cal.json", tmp_path / "evaluation.json"
    place = fleet / "s01"
    assert run("train", place / "train", "-o", cal, "--sensor-id", "s01", *QUICK) == 0
    assert cal.read_bytes() == (output / "s01" / "calibration.json").read_bytes()
    reference = statuses[1].judged.reference
    arguments = ("--calibration", cal, "--reference", reference, "--json", figures)
    assert run("evaluate", place / "holdout", *arguments) == 0
    assert figures.read_bytes() == (output / "s01" / "evaluation.json").read_bytes()
    compensated = json.loads(figures.read_text())["channels"][Z]["compensated"]
    assert statuses[1].channels[Z]["residual_peak_to_peak"] == compensated["span"]
    assert statuses[1].channels[Z]["velocity_random_walk"] == compensated["velocity_random_walk"]


def test_a_sensor_that_fails_says_why_and_leaves_no_results(calibrated):
    output, statuses = calibrated
    assert "holds no thermistor sample: record /accel/temperature" in statuses[3].reason
    assert [path.name for path in (output / "s03").iterdir()] == ["status.json"]


def test_a_single_recording_is_judged_on_its_end(tmp_path):
    place = tmp_path / "sensors" / "alone"
    write_recording(small(5), place.parent.parent / "bag")
    place.parent.mkdir()
    (tmp_path / "bag").rename(place)  # the sensor's folder is the recording itself
    (status,) = run_fleet(tmp_path / "sensors", tmp_path / "out")
    assert status.calibrated, status.reason
    limit = status.judged.limit
    assert limit == int(0.75 * (400.0 - 0.25))
    cal = tmp_path / "cal.json"
    assert run("train", place, "-o", cal, "--until", limit, "--sensor-id", "alone", *QUICK) == 0
    assert cal.read_bytes() == (tmp_path / "out" / "alone" / "calibration.json").read_bytes()
    # Judged on the end of what a node would have made of the whole.
    recording, calibration = read_recording(place), read_calibration(cal)
    made = compensate_recording(recording, calibration)
    rows = recording.stamps >= recording.start + limit * 1_000_000_000
    raw, temperature = recording.values[rows][:, [2]], made.features[rows, 0]
    reference = Reference.parse(status.judged.reference)
    expected = compare(recording.stamps[rows], raw, made.values[rows], temperature, calibration, reference)
    assert json.loads((tmp_path / "out" / "alone" / "evaluation.json").read_text()) == expected.as_json()


def test_of_several_recordings_the_last_in_time_is_judged_on(tmp_path):
    place = tmp_path / "sensors" / "s"
    place.mkdir(parents=True)
    for name, day in (("a", 3), ("b", 1), ("c", 2)):
        write_recording(small(day, day=day), place / name)
    (status,) = run_fleet(tmp_path / "sensors", tmp_path / "out")
    assert (status.judged.trained_on, status.judged.judged_on, status.judged.limit) == (("b", "c"), "a", None)


def test_nothing_is_done_twice_and_whatever_changed_is(fleet, calibrated, tmp_path, monkeypatch):
    output = shutil.copytree(calibrated[0], tmp_path / "out")
    before = contents(output)
    trained = []
    real = job_module.train
    monkeypatch.setattr(
        job_module, "train", lambda parts, options: trained.append(options.sensor_id) or real(parts, options)
    )

    def again(options=OPTIONS, source=fleet):
        trained.clear()
        statuses = run_fleet(source, output, options)
        return statuses, list(trained)

    statuses, done = again()
    assert (statuses, done) == (calibrated[1], ["s03"])  # what failed is tried again
    (output / "s00" / "status.json").unlink()
    (output / "s01" / "calibration.json").write_text("{}")
    text = (output / "s02" / "status.json").read_bytes()
    (output / "s02" / "status.json").write_bytes(text[: len(text) // 2])
    assert again()[1] == ["s00", "s01", "s02", "s03"]
    assert contents(output) == before
    assert again(replace(OPTIONS, training=replace(OPTIONS.training, seed=2)))[1] == ["s00", "s01", "s02", "s03"]
    assert contents(output) != before
    copy = shutil.copytree(fleet, tmp_path / "elsewhere")
    assert again(source=copy)[1] == ["s00", "s01", "s02", "s03"]
    assert contents(output) == before
    shutil.rmtree(copy / "s02" / "holdout")
    write_recording(small(77, day=2), copy / "s02" / "holdout")
    assert again(source=copy)[1] == ["s02", "s03"]


def test_a_sensor_that_breaks_loses_what_it_had(fleet, calibrated, tmp_path):
    output = shutil.copytree(calibrated[0], tmp_path / "out")
    source = shutil.copytree(fleet, tmp_path / "sensors")
    (file,) = (source / "s00" / "train").glob("*.mcap")
    file.write_bytes(file.read_bytes()[:-200])
    statuses = run_fleet(source, output)
    assert not statuses[0].calibrated
    assert str(tmp_path) not in statuses[0].reason
    assert [path.name for path in (output / "s00").iterdir()] == ["status.json"]
    assert statuses[1] == calibrated[1][1]


def test_a_defect_stops_only_its_sensor(fleet, tmp_path, monkeypatch):
    real = job_module.train

    def train(parts, options):
        if options.sensor_id == "s00":
            raise ZeroDivisionError("a bug")
        return real(parts, options)

    monkeypatch.setattr(job_module, "train", train)
    statuses = run_fleet(fleet, tmp_path / "out")
    assert statuses[0].reason.startswith("unexpected ZeroDivisionError: a bug")
    assert statuses[1].calibrated


def test_a_worker_that_is_killed_costs_nothing(fleet, calibrated, tmp_path):
    jobs = jobs_of(fleet, tmp_path / "out", OPTIONS)
    statuses = run_jobs(jobs, lambda all_: run_here(all_, 2, die_once_on_s01))
    (tmp_path / "out" / "died").unlink()  # it did die
    assert statuses == calibrated[1]
    assert contents(tmp_path / "out") == contents(calibrated[0])
    assert not multiprocessing.active_children()


def test_a_sensor_that_kills_its_worker_is_found_out_and_the_others_are_not_blamed(fleet, calibrated, tmp_path):
    jobs = jobs_of(fleet, tmp_path / "out", OPTIONS)
    statuses = run_jobs(jobs, lambda all_: run_here(all_, 2, die_on_s01))
    assert "killed twice" in statuses[1].reason
    assert [statuses[0], *statuses[2:]] == [calibrated[1][0], *calibrated[1][2:]]
    assert [path.name for path in (tmp_path / "out" / "s01").iterdir()] == ["status.json"]


def test_the_command_writes_a_summary_that_no_number_of_workers_changes(fleet, calibrated, tmp_path, capsys):
    limits = tmp_path / "limits.yaml"
    limits.write_text(f"acceptance: 1\n{Z}: {{residual_peak_to_peak: 1000.0}}\nangular_velocity: {{raw_span: 1.0}}\n")
    outputs = [tmp_path / "one", tmp_path / "two"]
    for workers, output in enumerate(outputs, start=1):
        arguments = ("--limits", limits, "--workers", workers, "--json", tmp_path / "s.json")
        assert run("fleet", fleet, "-o", output, *arguments, *QUICK) == 1  # s03 cannot be calibrated
    said = capsys.readouterr().out
    assert "4 sensors, 3 accepted, 1 failed; yield 75.0 %" in said
    assert "s03: not calibrated: train holds no thermistor" in said
    assert "no sensor has a channel that the limits for angular_velocity judge" in said
    assert contents(outputs[0]) == contents(outputs[1])
    for name in ("s01/calibration.json", "s01/evaluation.json", "s01/status.json"):
        assert contents(outputs[0])[name] == contents(calibrated[0])[name]
    summary = json.loads((tmp_path / "s.json").read_text())
    assert summary == json.loads((outputs[0] / "summary.json").read_text())
    assert summary["counts"] == {"sensors": 4, "accepted": 3, "rejected": 0, "calibrated": 0, "failed": 1}
    assert str(tmp_path) not in (outputs[0] / "summary.json").read_text()


def test_a_summary_judges_ranks_and_tells_why(calibrated):
    _, statuses = calibrated
    spans = sorted((s.channels[Z]["raw_span"], s.sensor) for s in statuses if s.calibrated)
    limits = Limits({Z: {"raw_span": 0.5 * (spans[1][0] + spans[2][0])}})
    summary = summarise(statuses[::-1], limits, OPTIONS)
    assert [unit.name for unit in summary.units] == ["s00", "s01", "s02", "s03"]
    assert [unit.name for unit in summary.worst] == [name for _, name in reversed(spans)]
    states = {unit.name: unit.state for unit in summary.units}
    least, middle, most = (name for _, name in spans)
    assert states == {least: State.ACCEPTED, middle: State.ACCEPTED, most: State.REJECTED, "s03": State.FAILED}
    assert summary.accepted_share == 0.5
    assert summary.worst[0].badness > 1.0 > summary.worst[1].badness
    assert str(summary.worst[0].broken[0]).startswith(f"{Z}: raw span ")
    rows = list(csv.DictReader(summary_csv(summary).splitlines()))
    assert [row["state"] for row in rows] == [states[row["sensor"]].value for row in rows]
    assert next(row for row in rows if row["sensor"] == most)["broken"] == "raw_span"
    assert float(rows[0]["raw_span"]) == statuses[0].channels[Z]["raw_span"]


def test_without_limits_nothing_is_accepted_or_rejected(calibrated):
    summary = summarise(calibrated[1], Limits(), OPTIONS)
    assert [unit.state for unit in summary.units] == [State.CALIBRATED] * 3 + [State.FAILED]
    assert summary.accepted_share is None
    deviations = [unit.status.channels[Z]["residual_standard_deviation"] for unit in summary.worst]
    assert deviations == sorted(deviations, reverse=True)


@pytest.mark.parametrize("limits", [Limits(), Limits({Z: {"residual_peak_to_peak": 1e-3, "raw_span": 1e6}})])
def test_the_page_is_whole_and_needs_nothing_else(calibrated, limits):
    nasty = replace(calibrated[1][3], sensor="<i>&", reason="<b>broken</b>")
    page = fleet_page(summarise([*calibrated[1], nasty], limits, OPTIONS), "Fleet <b>")
    checked = Checker(page)
    assert not {"script", "link", "img", "iframe", "i", "b"} & set(checked.tags)
    assert checked.tags.count("svg") == 10
    assert not [word for word in ("@import", "http:", "https:") if word in page]
    assert "<i>&" in words(page)
    assert ('badge unexplained">rejected' in page) == bool(limits)


def test_a_fleet_of_nothing_but_failures_has_a_page(tmp_path, capsys):
    (tmp_path / "sensors" / "empty").mkdir(parents=True)
    assert run("fleet", tmp_path / "sensors", "-o", tmp_path / "out", "--workers", "1") == 1
    assert "holds no recording" in (tmp_path / "out" / "summary.html").read_text()
    assert "1 failed" in capsys.readouterr().out


def test_mistakes_are_refused_before_anything_is_written(fleet, tmp_path, capsys):
    output = tmp_path / "out"
    assert "among the sensors" in refused(capsys, "fleet", fleet, "-o", fleet / "out")
    assert "among the sensors" in refused(capsys, "fleet", fleet, "-o", fleet)
    assert "exclude each other" in refused(
        capsys, "fleet", fleet, "-o", output, "--workers", "2", "--scheduler", "tcp://127.0.0.1:1"
    )
    assert "absent.yaml" in refused(capsys, "fleet", fleet, "-o", output, "--limits", tmp_path / "absent.yaml")
    assert "--reference" in refused(capsys, "fleet", fleet, "-o", output, "--reference", "up")
    assert "channel 'up' does not exist" in refused(capsys, "fleet", fleet, "-o", output, "--channels", "up")
    assert "is no directory" in refused(capsys, "fleet", tmp_path / "absent", "-o", output)
    assert "create the folder above" in refused(capsys, "fleet", fleet, "-o", tmp_path / "no" / "out")
    assert "create it first" in refused(capsys, "fleet", fleet, "-o", output, "--json", tmp_path / "no" / "s.json")
    (tmp_path / "file").touch()
    assert "is a file" in refused(capsys, "fleet", fleet, "-o", tmp_path / "file")
    assert not output.exists()


def test_results_never_go_into_the_recordings(tmp_path):
    source = tmp_path / "fleet"
    write_small_sensor(source / "fleet", 1)
    assert "the recordings" in refusal_of(jobs_of, source, tmp_path, OPTIONS)


def test_two_at_once_do_not_share_an_output(fleet, tmp_path):
    jobs = jobs_of(fleet, tmp_path / "out", OPTIONS)

    def engine(all_):
        yield from ()
        raise AssertionError(refusal_of(run_jobs, jobs, engine))

    with pytest.raises(AssertionError, match="another hgma fleet is writing"):
        run_jobs(jobs, engine)


def test_topics_and_hold_out_are_the_users(tmp_path):
    options = FleetOptions(OPTIONS.training, TopicNames(["/accel/temperature:=/oven/t"]), "second")
    assert options.as_json()["topics"]["accel/temperature"] == "/oven/t"
    write_small_sensor(tmp_path / "sensors" / "s", 1)
    (status,) = run_fleet(tmp_path / "sensors", tmp_path / "out", options)
    assert "no recording is named second (there are holdout, train)" in status.reason
    (status,) = run_fleet(tmp_path / "sensors", tmp_path / "out", replace(options, holdout="HOLD*"))
    assert "holds no thermistor" in status.reason


def test_interrupted_it_keeps_what_is_finished_and_goes_on_from_there(fleet, calibrated, tmp_path):
    output = tmp_path / "out"
    command = [sys.executable, "-m", "hgma_compensation.cli.main", "fleet", str(fleet), "-o", str(output)]
    command += ["--workers", "1", *QUICK]
    # A group of its own, as a terminal has: Ctrl-C reaches the workers too.
    process = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True
    )
    while process.poll() is None and not finished_in(output):
        time.sleep(0.01)
    os.killpg(process.pid, signal.SIGINT)
    _, said = process.communicate(timeout=60)
    assert process.returncode == 130, said
    assert said.count("\n") == 1
    assert "finished ones are kept; give the same command again" in said
    assert 1 <= finished_in(output) < 4
    assert not (output / "summary.json").exists()
    assert run_fleet(fleet, output) == calibrated[1]
    assert contents(output) == contents(calibrated[0])
