import threading
from pathlib import Path

import pytest
from builders import make_calibration
from restarts import file_of, started

from hgma_compensation.pipeline import state_saver
from hgma_compensation.pipeline.state_file import read_state
from hgma_compensation.pipeline.state_saver import StateSaver

LONG = 30.0


@pytest.fixture
def live():
    live = started(make_calibration())
    live.add_temperature(1, 25.0)
    return live


def newest(path):
    state = read_state(path)
    return None if state is None else state.newest()["temperature"]


def test_saves_happen_on_another_thread_and_the_last_one_counts(tmp_path, live):
    saver = StateSaver(tmp_path / "state")
    for stamp in (2, 3, 4):
        live.add_temperature(stamp, 25.0)
        assert saver.save(live.snapshot())
        assert saver.wait(LONG)
    assert (saver.saves, saver.failures, saver.skipped, saver.problem) == (3, 0, 0, "")
    assert saver.size == (tmp_path / "state").stat().st_size
    assert newest(tmp_path / "state") == 4


def test_the_snapshot_is_of_its_own_moment(tmp_path, live):
    expected, snapshot = file_of(live), live.snapshot()
    live.add_temperature(2, 30.0)
    saver = StateSaver(tmp_path / "state")
    saver.save(snapshot)
    saver.wait(LONG)
    assert (tmp_path / "state").read_bytes() == expected


class SlowDisk:
    """Stands between the saver and the file, and lets a write go on only when it is told to."""

    def __init__(self, monkeypatch):
        self.go, self._write = threading.Event(), state_saver.write_state
        monkeypatch.setattr(state_saver, "write_state", self.write)

    def write(self, *arguments):
        assert self.go.wait(LONG)
        return self._write(*arguments)


def test_a_slow_disk_skips_saves_and_queues_none(tmp_path, live, monkeypatch):
    disk, saver = SlowDisk(monkeypatch), StateSaver(tmp_path / "state")
    assert saver.save(live.snapshot())
    live.add_temperature(2, 25.0)
    assert not saver.save(live.snapshot())
    assert not saver.wait(0.01)
    assert saver.busy
    disk.go.set()
    assert saver.wait(LONG)
    assert (saver.saves, saver.skipped) == (1, 1)
    assert newest(tmp_path / "state") == 1


def test_a_save_that_is_under_way_does_not_survive_a_discard(tmp_path, live, monkeypatch):
    disk, saver = SlowDisk(monkeypatch), StateSaver(tmp_path / "state")
    saver.save(live.snapshot())
    saver.discard()
    assert saver.discarding
    disk.go.set()
    assert saver.wait(LONG)
    assert saver.saves == 1
    assert not saver.discarding
    assert list(tmp_path.iterdir()) == []


def test_discarding_nothing_is_no_failure(tmp_path):
    for path in (tmp_path / "state", tmp_path / "none" / "state"):
        saver = StateSaver(path)
        saver.discard()
        assert saver.wait(LONG)
        assert (saver.discarding, saver.failures) == (False, 0)


def test_a_folder_that_is_gone_is_a_problem_until_it_is_back(tmp_path, live):
    path = tmp_path / "folder" / "state"
    saver = StateSaver(path)
    saver.save(live.snapshot())
    saver.wait(LONG)
    assert (saver.saves, saver.failures) == (0, 1)
    assert f"{path} cannot be written (No such file or directory)" in saver.problem
    path.parent.mkdir()
    saver.save(live.snapshot())
    saver.wait(LONG)
    assert (saver.saves, saver.failures, saver.problem) == (1, 1, "")


def test_a_file_that_is_not_ours_is_neither_replaced_nor_removed(tmp_path, live):
    path = tmp_path / "calibration.json"
    path.write_text("{}")
    saver = StateSaver(path)
    for work in (lambda: saver.save(live.snapshot()), saver.discard):
        work()
        saver.wait(LONG)
        assert "left alone" in saver.problem
    assert path.read_text() == "{}"


def test_a_file_that_cannot_be_removed_is_said_and_still_to_be_removed():
    # Not even root can remove a file of the kernel's own; its size is 0, which is why it passes for an empty state.
    saver = StateSaver(Path("/proc/self/status"))
    saver.discard()
    saver.wait(LONG)
    assert saver.discarding
    assert "cannot be removed" in saver.problem
