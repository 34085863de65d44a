"""Where a calibration may lie, and what is no file to read."""

import os
import re
import socket
import threading
from pathlib import Path

import pytest
from builders import make_calibration

from hgma_compensation.calibration.document import read_calibration, write_calibration
from hgma_compensation.errors import RefusedError


@pytest.fixture
def places(tmp_path):
    """A directory with a calibration in it, and another one beside it."""
    for name, seed in (("inside", 1), ("outside", 2)):
        (tmp_path / name).mkdir()
        write_calibration(make_calibration(seed=seed), tmp_path / name / "sensor.json")
    return tmp_path / "inside", tmp_path / "outside"


def refusal(path, directory=None):
    with pytest.raises(RefusedError) as caught:
        read_calibration(path, directory=directory)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def outcome(path, directory=None):
    """Return the id of what was read, or the refusal."""
    try:
        return read_calibration(path, directory=directory).calibration_id
    except RefusedError as refusal:
        return str(refusal)


@pytest.mark.parametrize("way", ["sensor.json", "link.json", "deep/link.json", "../inside/sensor.json"])
def test_a_file_in_the_directory_is_read_by_whatever_path_leads_there(places, way):
    inside, _ = places
    (inside / "deep").mkdir()
    (inside / "link.json").symlink_to("sensor.json")
    (inside / "deep" / "link.json").symlink_to("../link.json")
    (inside.parent / "alias").symlink_to(inside)
    for directory in (inside, inside.parent / "alias", inside.parent):
        assert read_calibration(inside / way, directory=directory).calibration_id == make_calibration().calibration_id


@pytest.mark.parametrize("way", ["link.json", "folder/sensor.json", "../outside/sensor.json"])
def test_a_path_that_leaves_the_directory_is_refused_and_fine_without_one(places, way):
    inside, outside = places
    (inside / "link.json").symlink_to(outside / "sensor.json")
    (inside / "folder").symlink_to(outside)
    text = refusal(inside / way, directory=inside)
    assert f"lies at {outside / 'sensor.json'}, outside of the calibration directory {inside}" in text
    assert read_calibration(inside / way).calibration_id == make_calibration(seed=2).calibration_id


def test_a_directory_that_is_none_is_refused_not_taken_for_anywhere(places):
    inside, _ = places
    assert "check that this directory exists" in refusal(inside / "sensor.json", directory=inside / "none")
    neighbour = inside.parent / "ins"
    neighbour.mkdir()
    assert "outside of the calibration directory" in refusal(inside / "sensor.json", directory=neighbour)


def test_a_link_that_is_turned_while_it_is_followed_never_leads_outside(places):
    inside, outside = places
    link, stop = inside / "link.json", threading.Event()
    link.symlink_to(inside / "sensor.json")

    def turn():
        while not stop.is_set():
            for target in (outside, inside):
                (inside / "new").symlink_to(target / "sensor.json")
                os.replace(inside / "new", link)

    turner = threading.Thread(target=turn)
    turner.start()
    outcomes = {outcome(link, directory=inside) for _ in range(300)}
    stop.set()
    turner.join()
    outside_of = f"calibration {link}: lies at {outside / 'sensor.json'}, outside of the calibration directory {inside}"
    assert {o.partition(": copy")[0] for o in outcomes} == {make_calibration().calibration_id, outside_of}


@pytest.mark.parametrize(
    ("path", "reason"),
    [
        ("/dev/zero", "is not a regular file"),
        ("/dev/null", "is not a regular file"),
        ("/", "is not a regular file"),
        ("", "is not a regular file"),
        ("/proc/self/status", "is not complete JSON"),  # regular, of no size, and there is something to read
        ("a\0b", "is no path"),
        ("a\ud800b", "is no path"),
        ("x" * 5000, "cannot be opened (File name too long)"),
        ("~/sensor.json", "where ~ is not expanded"),
        ("sensor.json", f"(No such file or directory) in {os.getcwd()}: check the path"),
        ("/tmp/\x1b[2J\nsensor.json", r"'/tmp/\x1b[2J\nsensor.json'"),
    ],
)
def test_a_path_that_leads_to_no_file_is_refused_in_one_line(path, reason):
    text = refusal(Path(path))
    assert reason in text
    assert text.isprintable()
    assert len(text) < 600


def test_a_socket_is_refused_and_a_pipe_is_not_opened(tmp_path):
    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind(str(tmp_path / "socket"))
        assert "is not a regular file" in refusal(tmp_path / "socket")
    os.mkfifo(tmp_path / "pipe")
    met = threading.Event()

    def write():
        os.close(os.open(tmp_path / "pipe", os.O_WRONLY))  # waits until somebody opens the other end
        met.set()

    writer = threading.Thread(target=write)
    writer.start()
    for _ in range(20):
        assert "is not a regular file" in refusal(tmp_path / "pipe")
    assert not met.wait(0.05)
    os.close(os.open(tmp_path / "pipe", os.O_RDONLY))
    writer.join()


def test_a_file_that_is_rewritten_in_place_is_read_whole_or_refused(tmp_path):
    path, stop = tmp_path / "sensor.json", threading.Event()
    contents = []
    for seed in (1, 2):
        write_calibration(make_calibration(seed=seed), path)
        contents.append(path.read_bytes())

    def rewrite():
        while not stop.is_set():
            for content in contents:
                with open(path, "wb", buffering=0) as file:
                    for start in range(0, len(content), 1000):
                        file.write(content[start : start + 1000])

    writer = threading.Thread(target=rewrite)
    writer.start()
    outcomes = {outcome(path) for _ in range(200)}
    stop.set()
    writer.join()
    refusals = outcomes - {make_calibration(seed=seed).calibration_id for seed in (1, 2)}
    assert refusals
    assert all(re.search("complete JSON|changed after it was written", text) for text in refusals)


def test_half_of_one_file_and_half_of_another_is_refused(tmp_path):
    whole = []
    for seed in (1, 2):
        write_calibration(make_calibration(seed=seed, method="polynomial"), tmp_path / "sensor.json")
        whole.append((tmp_path / "sensor.json").read_text().splitlines(keepends=True))
    assert len(whole[0]) == len(whole[1])
    half = len(whole[0]) // 2
    (tmp_path / "sensor.json").write_text("".join(whole[0][:half] + whole[1][half:]))
    assert "the file was changed after it was written" in refusal(tmp_path / "sensor.json")
