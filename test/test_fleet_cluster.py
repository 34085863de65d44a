"""The same fleet on a Dask cluster: two worker processes, one of them killed in the middle of its work."""

import json
import os
import subprocess
import sys
import time
from pathlib import Path

import pytest
from fleet_folders import OPTIONS, QUICK, contents, finished_in, run_fleet, write_small_fleet
from refusals import refusal_of

from benchmarks.dask_processes import local_cluster
from hgma_compensation import __version__
from hgma_compensation.fleet import dask_engine
from hgma_compensation.fleet.limits import Limits
from hgma_compensation.fleet.page import fleet_page
from hgma_compensation.fleet.run import jobs_of
from hgma_compensation.fleet.summary import summarise

pytest.importorskip("distributed")
ROOT = Path(__file__).parents[1]
SENSORS = 12


@pytest.mark.slow
def test_a_killed_worker_loses_nothing_and_changes_nothing(tmp_path):
    source = write_small_fleet(tmp_path / "sensors", SENSORS)
    output, scratch = tmp_path / "on_cluster", tmp_path / "scratch"
    scratch.mkdir()
    paths = {"PYTHONPATH": os.pathsep.join([str(ROOT), str(ROOT / "test")])}
    with local_cluster(scratch, 2, paths) as cluster:
        command = [sys.executable, "-m", "hgma_compensation.cli.main", "fleet", str(source), "-o", str(output)]
        command += ["--scheduler", cluster.address, *QUICK]
        process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True, env={**os.environ, **paths})
        while process.poll() is None and finished_in(output) < 2:
            time.sleep(0.01)
        begun = {path.name for path in output.iterdir() if path.is_dir()}
        cluster.workers[0].kill()
        cluster.workers[0].wait()
        assert len(begun) < SENSORS  # there was work left to do
        _, said = process.communicate(timeout=200)
        assert process.returncode == 1, said  # the last sensor has no thermistor
        assert "Traceback" not in said
        assert cluster.workers[1].poll() is None
    statuses = run_fleet(source, tmp_path / "here")
    assert [status.calibrated for status in statuses] == [True] * (SENSORS - 1) + [False]
    ours = contents(tmp_path / "here")
    theirs = contents(output)
    page = fleet_page(summarise(statuses, Limits(), OPTIONS), "Fleet sensors")
    assert theirs.pop("summary.html").decode() == page
    assert {name for name in theirs if name not in ours} == {"summary.csv", "summary.json"}
    assert {name: theirs[name] for name in ours} == ours


IMPATIENT = """
import sys
from hgma_compensation.cli.main import main
from hgma_compensation.fleet import dask_engine
dask_engine.PATIENCE = 0.5
sys.exit(main(sys.argv[1:]))
"""


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:9", "no address", "ftp://somewhere:1"])
def test_a_scheduler_that_is_none_is_refused(tmp_path, address):
    source = tmp_path / "sensors"
    (source / "s").mkdir(parents=True)
    # A process of its own, as for a user: Dask's threads of other tests are none of its business.
    command = [
        sys.executable,
        "-c",
        IMPATIENT,
        "fleet",
        str(source),
        "-o",
        str(tmp_path / "out"),
        "--scheduler",
        address,
    ]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=120)
    assert done.returncode == 2
    assert done.stderr.startswith(f"error: --scheduler {address} does not answer")
    assert done.stderr.count("\n") == 1


def answer(**changes):
    return {"sensors": ["a"], "output": True, "versions": {"numpy": "2.0.0"}, **changes}


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"sensors": []}, "does not see what is in"),
        ({"output": False}, "or cannot write there"),
        ({"versions": {"numpy": "1.26.4"}}, "has numpy 1.26.4, this machine 2.0.0: install the same version"),
    ],
)
def test_a_worker_that_is_not_like_this_machine_is_refused(changes, words):
    places = Path("/fleet"), Path("/out")
    assert words in refusal_of(dask_engine._check_answer, "tcp://w", answer(**changes), answer(), *places)
    assert refusal_of(dask_engine._check_answer, "tcp://w", answer(), answer(), *places) is None


def test_a_worker_that_came_late_with_another_version_calibrates_nothing(tmp_path):
    (tmp_path / "sensors" / "s").mkdir(parents=True)
    (tmp_path / "out").mkdir()
    (job,) = jobs_of(tmp_path / "sensors", tmp_path / "out", OPTIONS)
    assert "install 9.9 there" in dask_engine.on_worker(job, "9.9").reason
    assert "install" not in dask_engine.on_worker(job, __version__).reason


class Broken:
    """A future that ends with an error of the cluster."""

    def __init__(self, error):
        self.error = error

    def result(self):
        raise self.error


def test_errors_of_the_cluster_are_told_with_their_remedy(tmp_path):
    distributed = pytest.importorskip("distributed")
    (tmp_path / "sensors" / "s").mkdir(parents=True)
    (tmp_path / "out").mkdir()
    (job,) = jobs_of(tmp_path / "sensors", tmp_path / "out", OPTIONS)
    killed = distributed.scheduler.KilledWorker("task", None, 3)
    assert "4 of them one after the other" in dask_engine._status(Broken(killed), job, "tcp://s").reason
    assert json.loads((tmp_path / "out" / "s" / "status.json").read_text())["judged"] is None
    other = dask_engine._status(Broken(OSError("no\nroute")), job, "tcp://s").reason
    assert other.startswith("the cluster failed on it (no route): give the same command again")
    lost = refusal_of(dask_engine._status, Broken(distributed.CancelledError("gone")), job, "tcp://s")
    assert "--scheduler tcp://s was lost: start it again" in lost
