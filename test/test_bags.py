import contextlib
from dataclasses import replace

import numpy as np
import pytest
from builders import LINEAR, make_calibration, make_recording
from effect_calibrations import OFFERED, applied, with_all_inputs

from hgma_compensation import topics
from hgma_compensation.errors import RefusedError
from hgma_compensation.kalman.settings import FilterMode
from hgma_compensation.messages import stamp_of
from hgma_compensation.pipeline.live import LiveCompensation
from hgma_compensation.recording import typestore as types
from hgma_compensation.recording.bag_reader import open_bag, read_messages, read_recording
from hgma_compensation.recording.bag_writer import Storage, new_bag, write_recording
from hgma_compensation.recording.compensated_bag import compensate_recording
from hgma_compensation.recording.compensated_copy import write_compensated
from hgma_compensation.recording.recording import Series

RECORDING = make_recording(duration_s=20.0, accel_rate=10.0, thermistor_rate=2.0, cycles=1.0, name="bag")


def messages(path, topic):
    with open_bag(path) as reader:
        connections = [c for c in reader.connections if c.topic == topic]
        return [reader.deserialize(raw, c.msgtype) for c, _, raw in read_messages(reader, path, connections)]


def assert_same(one, other):
    np.testing.assert_array_equal(one.stamps, other.stamps)
    np.testing.assert_array_equal(one.values, other.values)
    for name in ("temperature", "temperature_2", "supply_voltage"):
        np.testing.assert_array_equal(getattr(one, name).stamps, getattr(other, name).stamps)
        np.testing.assert_array_equal(getattr(one, name).values, getattr(other, name).values)
    assert one.present == other.present
    assert one.frame == other.frame


@pytest.mark.parametrize("storage", list(Storage))
def test_a_recording_survives_a_bag_bit_for_bit(tmp_path, storage):
    full = replace(RECORDING, temperature_2=RECORDING.temperature, supply_voltage=RECORDING.temperature)
    write_recording(full, tmp_path / "bag", storage)
    assert_same(read_recording(tmp_path / "bag"), full)


def test_the_same_recording_gives_the_same_bytes(tmp_path):
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
        write_recording(RECORDING, tmp_path / folder / "bag")
    one, other = (sorted((tmp_path / folder / "bag").iterdir()) for folder in ("a", "b"))
    assert [p.name for p in one] == [p.name for p in other] == ["bag.mcap", "metadata.yaml"]
    assert [p.read_bytes() for p in one] == [p.read_bytes() for p in other]


def test_channels_that_are_zero_or_declared_absent_are_not_present(tmp_path):
    only_z = make_recording(duration_s=5.0, channels=("linear_acceleration.z",))
    write_recording(only_z, tmp_path / "bag")
    assert read_recording(tmp_path / "bag").present == ("linear_acceleration.z",)
    message = messages(tmp_path / "bag", "/accel/raw")[0]
    assert message.angular_velocity_covariance[0] == message.orientation_covariance[0] == -1.0
    assert not message.linear_acceleration_covariance.any()


def test_topics_are_found_under_other_names(tmp_path):
    with new_bag(tmp_path / "bag") as bag:
        imu, temperature = bag.topic("/imu/data_raw", types.IMU), bag.topic("/imu/temp", types.TEMPERATURE)
        write_recording(RECORDING, tmp_path / "plain")
        for message in messages(tmp_path / "plain", "/accel/raw"):
            bag.write(imu, stamp_of(message), message)
        for message in messages(tmp_path / "plain", "/accel/temperature"):
            bag.write(temperature, stamp_of(message), message)
    with pytest.raises(RefusedError, match=r"/imu/data_raw, /imu/temp.*--remap"):
        read_recording(tmp_path / "bag")
    with pytest.raises(RefusedError, match=r"is a sensor_msgs/msg/Temperature, must be sensor_msgs/msg/Imu"):
        read_recording(tmp_path / "bag", topics.TopicNames(["/accel/raw:=/imu/temp"]))
    names = topics.TopicNames(["/accel/raw:=/imu/data_raw", "/imu/temp:=/accel/temperature"])
    assert_same(read_recording(tmp_path / "bag", names), RECORDING)


@pytest.mark.parametrize("rule", ["nonsense", "/a:=/b", "/accel/raw:="])
def test_a_remapping_without_a_topic_of_the_node_is_refused(rule):
    with pytest.raises(RefusedError, match="--remap"):
        topics.TopicNames([rule])


def write_blocks(path, values, count=50, interval=0.1):
    """Write the made recording with other values (n, 6) in blocks of so many samples."""
    temperatures = _temperatures(path.parent)
    with new_bag(path) as bag:
        block = bag.topic("/accel/raw_block", types.ACCEL_BLOCK)
        temperature = bag.topic("/accel/temperature", types.TEMPERATURE)
        for start in range(0, len(RECORDING.stamps), count):
            stamp = int(RECORDING.stamps[start])
            axes = values[start : start + count, :3].astype(np.float32).T
            message = bag.typestore.types[types.ACCEL_BLOCK](bag.header(stamp, "imu_link"), interval, *axes.copy())
            bag.write(block, stamp, message)
        for message in temperatures:
            bag.write(temperature, stamp_of(message), message)


def test_blocks_are_read_as_samples_and_compensated_as_blocks(tmp_path):
    write_blocks(tmp_path / "bag", RECORDING.values)
    recording = read_recording(tmp_path / "bag")
    np.testing.assert_array_equal(recording.stamps, RECORDING.stamps)
    np.testing.assert_array_equal(recording.values[:, :3], RECORDING.values[:, :3].astype(np.float32))
    result = compensate_recording(recording, make_calibration())
    write_compensated(tmp_path / "bag", make_calibration(), tmp_path / "out", names=topics.TopicNames())
    blocks = messages(tmp_path / "out", "/accel/compensated_block")
    z = np.concatenate([message.z for message in blocks])
    np.testing.assert_array_equal(z, result.values[:, 2].astype(np.float32))
    assert [len(message.x) for message in blocks] == [50] * 4


def test_a_sample_that_is_not_finite_costs_its_block_and_enters_no_filter_as_in_the_node(tmp_path):
    values = RECORDING.values.copy()
    values[70, 2] = np.nan
    write_blocks(tmp_path / "bag", values)
    recording, calibration = read_recording(tmp_path / "bag"), make_calibration(mode=FilterMode.SMOOTH)
    copied = write_compensated(tmp_path / "bag", calibration, tmp_path / "out", names=topics.TopicNames())
    assert (copied.samples, copied.compensated) == (200, 150)
    result = compensate_recording(recording, calibration)
    live = LiveCompensation()
    live.install(calibration)
    for stamp, celsius in zip(recording.temperature.stamps.tolist(), recording.temperature.values, strict=True):
        live.add_temperature(stamp, float(celsius))
    edges = np.arange(50, 200, 50)
    blocks = zip(np.split(recording.stamps, edges), np.split(recording.values, edges), strict=True)
    parts = [live.compensate(*block) for block in blocks]
    assert [part is None for part in parts] == [False, True, False, False]
    expected = np.concatenate([part.compensated.values for part in parts if part is not None])
    assert result.values.tobytes() == expected.tobytes()
    written = messages(tmp_path / "out", "/accel/compensated_block")
    np.testing.assert_array_equal(np.concatenate([m.z for m in written]), expected[:, 2].astype(np.float32))


def _temperatures(tmp_path):
    write_recording(RECORDING, tmp_path / "temperatures")
    return messages(tmp_path / "temperatures", "/accel/temperature")


def test_a_compensated_bag_holds_the_inputs_and_outputs_with_other_fields_untouched(tmp_path):
    write_recording(RECORDING, tmp_path / "in")
    calibration = make_calibration(channels=("linear_acceleration.z",))
    write_compensated(tmp_path / "in", calibration, tmp_path / "out", names=topics.TopicNames(), state_rate=0.0)
    raw, compensated = (messages(tmp_path / "out", f"/accel/{name}") for name in ("raw", "compensated"))
    state = messages(tmp_path / "out", "/accel/state")
    expected = compensate_recording(RECORDING, calibration)
    assert len(raw) == len(compensated) == len(state) == len(RECORDING.stamps)
    assert [m.linear_acceleration.z for m in compensated] == expected.values[:, 0].tolist()
    assert [m.drift.tolist() for m in state] == expected.drift.tolist()
    assert {m.calibration_id for m in state} == {calibration.calibration_id}
    assert not any(m.linear_acceleration_covariance[:8].any() for m in compensated)
    grown = [m.linear_acceleration_covariance[8] for m in compensated]
    assert grown == np.where(expected.status > 0, expected.uncertainty[:, 0] ** 2, 0.0).tolist()
    assert [m.uncertainty.tolist() for m in state] == expected.uncertainty.tolist()
    for before, after in zip(raw, compensated, strict=True):
        after.linear_acceleration.z = before.linear_acceleration.z
        after.linear_acceleration_covariance = before.linear_acceleration_covariance
        assert bag_bytes(before) == bag_bytes(after)
    assert len(messages(tmp_path / "out", "/accel/temperature")) == len(RECORDING.temperature.stamps)


def bag_bytes(message):
    return bytes(types.typestore().serialize_cdr(message, types.IMU))


def test_samples_that_are_not_finite_are_left_out_of_the_output(tmp_path):
    values = RECORDING.values.copy()
    values[[7, 8], 0] = np.nan, np.inf
    write_recording(replace(RECORDING, values=values), tmp_path / "in")
    write_compensated(tmp_path / "in", make_calibration(), tmp_path / "out", names=topics.TopicNames())
    stamps = [stamp_of(message) for message in messages(tmp_path / "out", "/accel/compensated")]
    assert stamps == np.delete(RECORDING.stamps, [7, 8]).tolist()


def test_a_bag_that_cannot_be_read_is_refused_with_its_name(tmp_path):
    with pytest.raises(RefusedError, match="missing does not exist"):
        read_recording(tmp_path / "missing")
    (tmp_path / "empty").mkdir()
    with pytest.raises(RefusedError, match=r"no metadata.yaml.*reindex"):
        read_recording(tmp_path / "empty")
    (tmp_path / "text.mcap").write_text("not a bag")
    with pytest.raises(RefusedError, match=r"text.mcap"):
        read_recording(tmp_path / "text.mcap")


@pytest.mark.parametrize("share", [0.0, 0.1, 0.5, 0.9, 0.99])
@pytest.mark.parametrize("storage", list(Storage))
def test_a_truncated_bag_is_refused_or_read_in_part_but_never_a_traceback(tmp_path, storage, share):
    write_recording(RECORDING, tmp_path / "bag", storage)
    file = next(p for p in (tmp_path / "bag").iterdir() if p.name != "metadata.yaml")
    content = file.read_bytes()
    file.write_bytes(content[: int(len(content) * share)])
    samples = 0
    with contextlib.suppress(RefusedError):  # any other exception would be a traceback for a damaged file
        samples = len(read_recording(tmp_path / "bag").stamps)
    assert samples < len(RECORDING.stamps)


def test_nothing_is_overwritten_and_nothing_half_written_is_left(tmp_path):
    write_recording(RECORDING, tmp_path / "bag")
    with pytest.raises(RefusedError, match="exists"):
        write_recording(RECORDING, tmp_path / "bag")
    with pytest.raises(RefusedError, match="no directory"):
        write_recording(RECORDING, tmp_path / "nowhere" / "bag")

    def interrupt(_):
        raise KeyboardInterrupt

    long = make_recording(duration_s=100.0, accel_rate=20.0)
    with pytest.raises(KeyboardInterrupt):
        write_recording(long, tmp_path / "interrupted", progress=interrupt)
    assert [path.name for path in tmp_path.iterdir()] == ["bag"]


def test_a_part_is_cut_out_by_time_from_the_start():
    part = RECORDING.cut(5.0, 10.0)
    assert part.stamps[0] == RECORDING.stamps[50]
    assert part.stamps[-1] == RECORDING.stamps[99]
    assert part.temperature.stamps[0] == RECORDING.temperature.stamps[10]
    assert len(part.temperature.stamps) == 10
    with pytest.raises(RefusedError, match="no sample from 100 s"):
        RECORDING.cut(100.0, None)


def test_a_recording_without_thermistor_says_which_topic_is_missing():
    with pytest.raises(RefusedError, match=r"/accel/temperature"):
        replace(RECORDING, temperature=Series.empty()).require_temperature()


def test_a_bag_with_every_input_is_compensated_with_the_effects_that_need_them(tmp_path):
    recording = with_all_inputs()
    wanted = [effect for effect in OFFERED[LINEAR[2]] if effect.needs]
    effects = [applied(LINEAR[2], effect, np.random.default_rng(1)) for effect in wanted]
    calibration = make_calibration(channels=LINEAR[2:], effects=effects)
    write_recording(recording, tmp_path / "in")
    write_compensated(tmp_path / "in", calibration, tmp_path / "out", names=topics.TopicNames(), state_rate=0.0)
    drift = [message.drift.tolist() for message in messages(tmp_path / "out", "/accel/state")]
    assert drift == compensate_recording(recording, calibration).drift.tolist()
    for topic, series in (("temperature_2", recording.temperature_2), ("supply_voltage", recording.supply_voltage)):
        assert len(messages(tmp_path / "out", f"/accel/{topic}")) == len(series.stamps)
