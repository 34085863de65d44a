"""Parts of the benchmark run for real, for a second: no figure is judged here."""

import sys
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.bench import bags, filtering
from benchmarks.bench.bags import Content, bag
from benchmarks.bench.commands import run, run_writing
from benchmarks.bench.given import Given
from benchmarks.bench.row import Target
from hgma_compensation.recording.bag_reader import read_recording
from hgma_compensation.recording.bag_writer import Storage


def test_the_filter_is_measured_against_filterpy(monkeypatch, tmp_path):
    monkeypatch.setattr(filtering, "OURS", 3000)
    monkeypatch.setattr(filtering, "RIVALS", 100)
    said = []
    result = filtering.measure(Given(3, tmp_path, tmp_path, None, said.append))
    (row,) = result.rows
    assert len(row.ratios) == len(said) == 3
    assert min(row.ours + row.rival) > 0.0
    assert row.target == Target(500.0, at_least=True)


@pytest.mark.parametrize("content", [Content(607.0, 4.0, thermistor_rate=0.5), Content(30.0, 100.0, block=300)])
def test_a_made_bag_holds_what_it_says(content, tmp_path, monkeypatch):
    pytest.importorskip("rclpy")
    monkeypatch.setattr(bags, "CHUNK", 1000)  # so that there are several
    path = bag(content, tmp_path)
    assert bag(content, tmp_path) == path
    recording = read_recording(path)
    assert len(recording.stamps) == content.samples
    assert np.allclose(np.diff(recording.stamps), 1e9 / content.rate, rtol=1e-6)
    assert len(recording.temperature.stamps) == np.ceil(content.seconds * content.thermistor_rate)
    assert np.ptp(recording.values[:, 2]) > 0.0
    assert recording.present == ("linear_acceleration.x", "linear_acceleration.y", "linear_acceleration.z")


@pytest.mark.parametrize("storage", list(Storage))
def test_the_copy_holds_the_same_messages(storage, tmp_path):
    pytest.importorskip("rclpy")
    path = bag(replace(Content(20.0, 10.0), storage=storage), tmp_path)
    run([sys.executable, "-m", "benchmarks.bench.copy_bag", path, tmp_path / "copy", storage.value])
    source, copy = read_recording(path), read_recording(tmp_path / "copy")
    assert np.array_equal(source.stamps, copy.stamps)
    assert np.array_equal(source.values, copy.values)
    assert np.array_equal(source.temperature.values, copy.temperature.values)


def test_a_command_is_run_with_its_own_peak_memory(tmp_path):
    ballast = bytearray(80_000_000)
    ballast[::4096] = b"x" * len(ballast[::4096])
    small = run([sys.executable, "-S", "-c", "pass"])
    large = run([sys.executable, "-S", "-c", "x = b'x' * 60_000_000"])
    assert 0.0 < small.peak_megabytes < 50.0 < large.peak_megabytes
    assert small.seconds > 0.0


def test_a_command_that_fails_is_no_figure_and_leaves_nothing(tmp_path):
    output = tmp_path / "output"
    with pytest.raises(RuntimeError, match="the reason"):
        run_writing(output, [sys.executable, "-c", f"open({str(output)!r}, 'w'); raise SystemExit('the reason')"])
    assert not output.exists()


@pytest.mark.ros
def test_a_stream_through_the_plain_relay_is_accounted_for(environment, monkeypatch):
    for name, value in environment.items():
        monkeypatch.setenv(name, value)
    from benchmarks.bench.messages import imu_peer
    from benchmarks.bench.processes import peak_megabytes, relay_command, started
    from benchmarks.bench.trials import latencies, stream_through, warm_up

    with started(relay_command("imu", 1000, "reliable")) as process, imu_peer() as peer:
        warm_up(peer, process)
        trial = stream_through(peer, process, 100.0, 1.0)
        times = latencies(peer, 50.0, 0.4)
        assert peak_megabytes(process.pid) > 10.0
    assert (trial.sent, trial.lost, trial.changed) == (100, 0, 0)
    assert 0.0 < trial.cpu_per_message < 1.0
    assert 0 < len(times) <= 20
    assert min(times) > 0.0


@pytest.mark.ros
@pytest.mark.parametrize(
    ("above", "limit"),
    [
        ([], False),
        ([(1100.0, False), (1100.0, False), (1500.0, True)], True),
        ([(1100.0, False), (1100.0, True)], False),
        ([(1100.0, True), (1100.0, True), (1500.0, False)], False),
    ],
)
def test_the_source_is_the_limit_where_it_always_fell_behind_at_the_next_rate(above, limit):
    from benchmarks.bench.messages import source_was_the_limit
    from benchmarks.bench.trials import Trial

    def trial(rate, kept):
        return Trial(rate, sent=10, lost=0, changed=0, cpu=1.0, source_kept=kept, source_late_99=0.0, behind=0.0)

    trials = [trial(900.0, False), trial(1000.0, True), *(trial(*case) for case in above)]
    assert source_was_the_limit(trials, 1000.0) is limit


def test_what_comes_back_is_counted_by_its_numbers():
    pytest.importorskip("rclpy")
    from benchmarks.bench.imu_stream import ImuStream
    from benchmarks.soak.serialised import NUMBER, acceleration_at

    stream = ImuStream(100.0, 0)
    messages = [stream.message(number) for number in range(10)]
    received = stream.received(messages)
    assert (received.lost(10), received.changed) == (0, 0)
    changed = bytearray(messages[3])
    for axis in range(3):
        NUMBER.pack_into(changed, acceleration_at() + 8 * axis, 1.0)
    received = stream.received([*messages[:3], bytes(changed), *messages[5:9], messages[8]])
    assert (received.lost(10), received.changed) == (2, 1)
    with pytest.raises(RuntimeError, match="length"):
        stream.received([messages[0] + b"0000"])


def test_a_start_is_measured_until_its_first_answer(tmp_path):
    pytest.importorskip("rclpy")
    from benchmarks.bench.one_start import profile
    from benchmarks.bench.processes import relay_command
    from benchmarks.bench.start import _start
    from hgma_compensation.demo.processes import private_ros_environment

    environment = private_ros_environment() | profile(tmp_path)
    start = _start(relay_command("imu", 1000), environment, 0.0, ours=False)
    assert 0.05 < start.processor < start.seconds + 1.0
    assert 10.0 < start.peak_megabytes < 1000.0
    with pytest.raises(RuntimeError, match="ended with 3"):
        _start([sys.executable, "-c", "raise SystemExit(3)"], environment, 0.0, ours=False)
