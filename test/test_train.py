from dataclasses import replace

import numpy as np
import pytest
from builders import LINEAR, make_recording

from hgma_compensation.calibration.document import parse_calibration, write_calibration
from hgma_compensation.drift.radial_basis import RadialBasisDrift
from hgma_compensation.errors import RefusedError
from hgma_compensation.kalman.settings import FilterMode
from hgma_compensation.recording.compensated_bag import compensate_recording
from hgma_compensation.training.genetic import GeneticSettings
from hgma_compensation.training.methods import Method
from hgma_compensation.training.reference import Reference
from hgma_compensation.training.train import TrainingOptions, train

RECORDING = make_recording(seed=2, duration_s=400.0, cycles=2.0)
QUICK = GeneticSettings(centres=4, population=20, generations=10)


@pytest.mark.parametrize("method", list(Method))
def test_every_method_makes_a_calibration_that_survives_its_file(tmp_path, method):
    calibration = train([RECORDING], TrainingOptions(method=method, genetic=QUICK, delay=10.0))
    write_calibration(calibration, tmp_path / "cal.json")
    content = (tmp_path / "cal.json").read_bytes()
    read = parse_calibration(content)
    assert read.calibration_id == calibration.calibration_id
    assert calibration.names == LINEAR
    one, other = (compensate_recording(RECORDING, c) for c in (calibration, read))
    assert one.values.tobytes() == other.values.tobytes()
    write_calibration(read, tmp_path / "again.json")
    assert (tmp_path / "again.json").read_bytes() == content


def test_the_same_seed_gives_the_same_calibration_and_another_another():
    options = TrainingOptions(genetic=QUICK, delay=10.0)
    ids = [train([RECORDING], replace(options, seed=seed)).calibration_id for seed in (1, 1, 2)]
    assert ids[0] == ids[1] != ids[2]


def test_a_channel_is_trained_alike_whichever_others_are_trained_beside_it():
    options = TrainingOptions(genetic=QUICK, delay=10.0)
    alone = train([RECORDING], replace(options, channels=("linear_acceleration.z",))).channels[0].drift
    beside = train([RECORDING], options).channels[2].drift
    assert isinstance(alone, RadialBasisDrift)
    assert alone.centres.tobytes() == beside.centres.tobytes()
    assert alone.weights.tobytes() == beside.weights.tobytes()


def test_the_reference_is_what_the_compensated_output_keeps():
    options = TrainingOptions(method=Method.POLYNOMIAL, delay=10.0, reference=Reference((9.81,)))
    calibration = train([RECORDING], options)
    assert [channel.reference for channel in calibration.channels] == [9.81] * 3
    assert compensate_recording(RECORDING, calibration).values.mean() == pytest.approx(9.81, abs=0.2)


def test_a_filter_is_designed_from_the_noise_of_the_recording():
    options = TrainingOptions(method=Method.POLYNOMIAL, filter=FilterMode.SMOOTH, filter_time_constant=2.0, delay=10.0)
    noise = train([RECORDING], options).channels[0].filter.noise
    # 0.05 m/s² a sample at 20 Hz; the median of |second differences| has about 2 % error on 8000 samples.
    assert noise.white == pytest.approx(0.05 / np.sqrt(20.0), rel=0.08)
    assert noise.white / noise.walk == pytest.approx(2.0)


def test_recordings_are_fitted_together():
    parts = [make_recording(seed=4, low=-10, high=30, name="cold"), make_recording(seed=5, low=20, high=60, name="hot")]
    calibration = train(parts, TrainingOptions(method=Method.POLYNOMIAL, delay=10.0))
    assert [r["name"] for r in calibration.training["recordings"]] == ["cold", "hot"]
    assert calibration.calibrated_range.lower[0] < -8
    assert calibration.calibrated_range.upper[0] > 58


def test_what_a_recording_cannot_carry_is_said():
    options = TrainingOptions(method=Method.POLYNOMIAL, delay=10.0)
    only_z = make_recording(duration_s=400.0, channels=("linear_acceleration.z",))
    with pytest.raises(RefusedError, match=r"made has no channel linear_acceleration\.x"):
        train([only_z], replace(options, channels=("linear_acceleration.x",)))
    with pytest.raises(RefusedError, match="no channel in common"):
        train([only_z, make_recording(duration_s=400.0, channels=("linear_acceleration.x",))], options)
    with pytest.raises(RefusedError, match="record for longer"):
        train([make_recording(duration_s=60.0)], options)
    with pytest.raises(RefusedError, match="there is no drift to learn"):
        train([make_recording(low=25.0, high=25.1)], options)
