import hashlib
import json
import os
import re
import stat
from dataclasses import replace

import numpy as np
import pytest
from builders import LINEAR, make_calibration
from effect_calibrations import OFFERED, applied

from hgma_compensation.calibration.document import parse_calibration, read_calibration, write_calibration
from hgma_compensation.errors import RefusedError
from hgma_compensation.kalman.settings import FilterMode
from hgma_compensation.temperature.features import Product

KINDS = {
    "rbf": {},
    "polynomial": {"method": "polynomial", "delay": 17.3, "latency": 0.07},
    "smooth": {"mode": FilterMode.SMOOTH, "product": Product.REFERENCE},
    "effects": {
        "effects": [applied(LINEAR[1], effect, np.random.default_rng(5)) for effect in OFFERED[LINEAR[1]][:64]]
    },
}


@pytest.fixture(params=KINDS)
def kind(request):
    return make_calibration(**KINDS[request.param])


def test_file_to_calibration_to_file_is_bit_for_bit(kind, tmp_path):
    write_calibration(kind, tmp_path / "first.json")
    read = read_calibration(tmp_path / "first.json")
    write_calibration(read, tmp_path / "second.json")
    assert (tmp_path / "second.json").read_bytes() == (tmp_path / "first.json").read_bytes()
    features = np.random.default_rng(20190725).uniform([-10.0, -0.1, -100.0], [60.0, 0.1, 100.0], (100, 3))
    for ours, theirs in zip(read.channels, kind.channels, strict=True):
        assert ours.drift.evaluate(features).tobytes() == theirs.drift.evaluate(features).tobytes()
        assert replace(ours, drift=None) == replace(theirs, drift=None)
    assert [replace(e, gains=None) for e in read.effects] == [replace(e, gains=None) for e in kind.effects]
    for ours, theirs in zip(read.effects, kind.effects, strict=True):
        assert ours.gains.tobytes() == theirs.gains.tobytes()
    assert read.features == kind.features
    assert (read.sensor_id, read.training, read.calibration_id) == (kind.sensor_id, kind.training, kind.calibration_id)


def test_id_is_that_of_the_content():
    assert make_calibration().calibration_id == make_calibration().calibration_id
    assert (
        make_calibration().calibration_id == "sha256-c0d41d9ef50be019"
    )  # of every file written before there were effects
    others = [make_calibration(seed=2), make_calibration(delay=21.0), make_calibration(sensor_id="other")]
    assert len({c.calibration_id for c in [make_calibration(), *others]}) == 4


def test_id_is_computed_as_the_schema_says(calibration_file):
    document = json.loads(calibration_file.read_text())
    written = document.pop("calibration_id")
    canonical = json.dumps(document, sort_keys=True, separators=(",", ":"))
    assert written == "sha256-" + hashlib.sha256(canonical.encode()).hexdigest()[:16]


def test_id_does_not_depend_on_order_or_white_space(calibration_file):
    document = json.loads(calibration_file.read_text())
    compact = json.dumps(dict(reversed(document.items())), separators=(",", ":"))
    assert parse_calibration(compact.encode()).calibration_id == document["calibration_id"]


def test_writing_replaces_the_file_whole(calibration_file, kind):
    write_calibration(kind, calibration_file)
    assert read_calibration(calibration_file).calibration_id == kind.calibration_id
    assert os.listdir(calibration_file.parent) == [calibration_file.name]
    umask = os.umask(0)
    os.umask(umask)
    assert stat.S_IMODE(calibration_file.stat().st_mode) == 0o666 & ~umask


@pytest.mark.parametrize("place", ["missing/new.json", "sensor.json/new.json", "folder"])
def test_writing_where_it_cannot_be_leaves_nothing_behind(calibration_file, calibration, place):
    target = calibration_file.parent / place
    (calibration_file.parent / "folder").mkdir()
    before = calibration_file.read_bytes()
    with pytest.raises(RefusedError, match=rf"^{re.escape(str(target))} cannot be written .*: choose another place$"):
        write_calibration(calibration, target)
    assert sorted(os.listdir(calibration_file.parent)) == ["folder", "sensor.json"]
    assert os.listdir(calibration_file.parent / "folder") == []
    assert calibration_file.read_bytes() == before


@pytest.mark.parametrize("call", ["fsync", "replace"])
def test_write_that_fails_halfway_keeps_the_old_file(calibration_file, monkeypatch, call):
    def fail(*_):
        raise OSError(28, "No space left on device")

    before = calibration_file.read_bytes()
    monkeypatch.setattr(os, call, fail)
    with pytest.raises(RefusedError, match="No space left on device"):
        write_calibration(make_calibration(seed=2), calibration_file)
    assert os.listdir(calibration_file.parent) == [calibration_file.name]
    assert calibration_file.read_bytes() == before


def test_calibration_with_a_number_that_is_none_is_not_written(calibration_file):
    before = calibration_file.read_bytes()
    with pytest.raises(ValueError, match="not JSON compliant"):
        write_calibration(replace(make_calibration(), training={"block": float("nan")}), calibration_file)
    assert os.listdir(calibration_file.parent) == [calibration_file.name]
    assert calibration_file.read_bytes() == before
