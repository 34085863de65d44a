import hashlib
import json
import os
import resource
import stat

import numpy as np
import pytest
from builders import LINEAR, make_calibration
from effect_calibrations import OFFERED, applied, with_all_inputs
from hypothesis import given, settings
from hypothesis import strategies as st
from jsonschema import Draft202012Validator
from restarts import Stream, file_of, started

from hgma_compensation.errors import RefusedError
from hgma_compensation.pipeline.live_state import LiveState
from hgma_compensation.pipeline.state_file import (
    LARGEST_FILE,
    check_replaceable,
    encode_bytes,
    parse_state,
    read_state,
    remove_litter,
    write_state,
)
from hgma_compensation.schema_check import load_schema

SCHEMA = load_schema("hgma_compensation.pipeline", "state.schema.json")
RECORDING = with_all_inputs()
HALF, ROWS = len(RECORDING.stamps) // 2, len(RECORDING.stamps)
KINDS = {effect.name: effect for effect in OFFERED[LINEAR[2]]}
CALIBRATION = make_calibration(
    effects=[applied(LINEAR[2], effect, np.random.default_rng(1)) for effect in KINDS.values()]
)


def halfway():
    live, stream = started(CALIBRATION), Stream(RECORDING)
    stream.send(live, HALF)
    return live, stream


LIVE, _ = halfway()
CONTENT = file_of(LIVE)


def no_rest():
    """Let nobody run in between."""


def sealed(content):
    """Return the bytes of a file with this content and the checksum that fits it."""
    body = json.dumps(content, allow_nan=True).encode()
    header = f'{{"format":"hgma_state","version":1,"checksum":"sha256-{hashlib.sha256(body).hexdigest()}","content":'
    return header.encode() + body + b"}\n"


def content():
    return json.loads(CONTENT)["content"]


def refusal_of(path):
    """Return the text of the refusal after the path."""
    with pytest.raises(RefusedError) as caught:
        read_state(path)
    text = str(caught.value)
    assert text.startswith(f"state_file {path}")
    return text.removeprefix(f"state_file {path}")


def test_a_written_state_is_read_back_and_follows_the_published_schema(tmp_path):
    size = write_state(LIVE.snapshot(), tmp_path / "state", no_rest)
    assert (tmp_path / "state").stat().st_size == size
    assert encode_bytes(read_state(tmp_path / "state"), no_rest) == CONTENT
    Draft202012Validator.check_schema(SCHEMA)
    Draft202012Validator(SCHEMA).validate(content())
    assert sealed(content())[:30] == CONTENT[:30]
    parse_state(sealed(content()))


def test_an_empty_state_is_read_back_too():
    assert parse_state(encode_bytes(LiveState(remembered=LIVE.snapshot().remembered), no_rest)).pipeline is None


def test_there_is_no_state_before_the_first_save(tmp_path):
    assert read_state(tmp_path / "state") is None
    assert read_state(tmp_path / "none" / "state") is None


@pytest.mark.parametrize("length", [0, 1, 20, 100, 1000, len(CONTENT) - 1])
def test_a_truncated_file_is_refused(tmp_path, length):
    (tmp_path / "state").write_bytes(CONTENT[:length])
    assert refusal_of(tmp_path / "state").startswith(": ")


@settings(max_examples=150)
@given(place=st.integers(0, len(CONTENT) - 1), byte=st.integers(0, 255))
def test_a_file_with_any_other_byte_is_refused(place, byte):
    damaged = CONTENT[:place] + bytes([byte]) + CONTENT[place + 1 :]
    if damaged != CONTENT:
        with pytest.raises(RefusedError):
            parse_state(damaged)


@settings(max_examples=100)
@given(start=st.sampled_from([b"", CONTENT[:23], CONTENT[:120]]), rest=st.binary(max_size=300))
def test_random_bytes_are_refused(start, rest):
    with pytest.raises(RefusedError):
        parse_state(start + rest)


def test_what_is_no_file_of_ours_is_refused_and_left_alone(tmp_path):
    path = tmp_path / "state"
    os.mkfifo(path)
    assert refusal_of(path) == ": is not a regular file: name another state_file"
    for make in (path.unlink, path.mkdir):
        make()
    assert "not a regular file" in refusal_of(path)
    with pytest.raises(RefusedError, match="holds something else, which is left alone: name another state_file"):
        write_state(LIVE.snapshot(), path, no_rest)
    path.rmdir()
    path.write_text("my notes")
    assert refusal_of(path).endswith("this is not a state written by compensation_node: name another state_file")
    with pytest.raises(RefusedError, match="left alone"):
        write_state(LIVE.snapshot(), path, no_rest)
    assert path.read_text() == "my notes"
    with pytest.raises(RefusedError, match="left alone"):
        check_replaceable(tmp_path)


def test_a_file_that_is_too_large_is_refused_unread(tmp_path):
    with (tmp_path / "state").open("wb") as file:
        file.truncate(LARGEST_FILE + 1)
    assert f"more than {LARGEST_FILE}" in refusal_of(tmp_path / "state")


def test_a_newer_version_is_refused_by_name():
    with pytest.raises(RefusedError, match="version is 2, this program reads version 1"):
        parse_state(CONTENT.replace(b'"version":1', b'"version":2', 1))


def set_at(*keys, value):
    def change(document):
        for key in keys[:-1]:
            document = document[key]
        document[keys[-1]] = value

    return change


@pytest.mark.parametrize(
    ("change", "field"),
    [
        (set_at("pipeline", value=[]), "pipeline is an array"),
        (set_at("inputs", "temperature", "stamps", value=[1]), "inputs.temperature has 1 stamps and"),
        (set_at("inputs", "temperature", "stamps", 0, value=10**30), r"inputs.temperature.stamps\[0\]"),
        (set_at("inputs", "temperature", "values", 0, value=float("nan")), "NaN"),
        (set_at("inputs", "temperature", "values", 0, value=1e300), r"inputs.temperature.values\[0\]"),
        (set_at("span", "began", value="yesterday"), "span.began"),
        (set_at("acceleration", value=0.5), "acceleration is 0.5"),
        (set_at("more", value=1), "unknown field 'more'"),
        (set_at("pipeline", "stretches", 1, value=True), r"pipeline.stretches\[1\]"),
        (set_at("pipeline", "effects", 0, value="x"), r"pipeline.effects\[0\]"),
        (set_at("pipeline", "inputs", "temperature", "updates", "values", 0, value=[[]]), "updates.values"),
    ],
)
def test_an_edited_file_is_refused_with_the_field(change, field):
    document = content()
    change(document)
    with pytest.raises(RefusedError, match=field):
        parse_state(sealed(document))


NUMBERS = st.one_of(
    st.none(), st.booleans(), st.integers(-(10**19), 10**19), st.floats(), st.text(max_size=5), st.just([]), st.just({})
)


def places(document, path=()):
    """Yield the path of every value in a document; of long lists, of the first and the last."""
    yield path
    children = document.items() if isinstance(document, dict) else ()
    if isinstance(document, list) and document:
        children = [(0, document[0]), (len(document) - 1, document[-1])]
    for key, child in children:
        yield from places(child, (*path, key))


PLACES = [path for path in places(content()) if path]


@settings(max_examples=200)
@given(changes=st.lists(st.tuples(st.sampled_from(PLACES), NUMBERS), min_size=1, max_size=3))
def test_a_forged_file_is_refused_or_used_and_never_stops_the_stream(changes):
    document = content()
    for path, value in changes:
        try:
            set_at(*path, value=value)(document)
        except (TypeError, KeyError, IndexError):
            continue  # an earlier change took the place away
    _, stream = halfway()
    again = started(CALIBRATION)
    try:
        again.offer(parse_state(sealed(document)), 1e7)
    except RefusedError:
        return
    with np.errstate(all="ignore"):
        drift = stream.send(again, ROWS)
    assert len(drift) == ROWS - HALF


@pytest.mark.parametrize(
    ("path", "value"),
    [(("pipeline", "inputs", "temperature", "filter"), [25.0, 0.0, -1e-4, 0.0, 0.0])],
)
def test_a_forged_covariance_makes_the_memory_begin_from_its_samples(path, value):
    document = content()
    set_at(*path, value=value)(document)
    _, stream = halfway()
    again = started(CALIBRATION)
    again.offer(parse_state(sealed(document)), 1e7)
    stream.send(again, ROWS)
    assert again.past.value == "replayed"


def test_what_interrupted_writes_left_is_removed_and_nothing_else(tmp_path):
    path = tmp_path / "state.json"
    others = {".state.json", ".state.json.bak", "state.json.ab12cd34", ".other.json.ab12cd34", ".state.json.AB12CD34"}
    for name in (*others, ".state.json.ab12cd3_", ".state.json.abcdefgh"):
        (tmp_path / name).touch()
    (tmp_path / ".state.json.directry").mkdir()
    assert remove_litter(path) == 2
    assert {entry.name for entry in tmp_path.iterdir()} == others | {".state.json.directry"}
    assert remove_litter(tmp_path / "none" / "state.json") == 0


def test_a_full_disk_leaves_the_old_file_and_no_litter(tmp_path):
    path = tmp_path / "state"
    write_state(LIVE.snapshot(), path, no_rest)
    # Python ignores SIGXFSZ, so that a write beyond the limit fails like one on a full disk.
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, limits[1]))
    try:
        with pytest.raises(RefusedError, match=r"cannot be written \(File too large\)"):
            write_state(halfway()[0].snapshot(), path, no_rest)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert path.read_bytes() == CONTENT
    assert [entry.name for entry in tmp_path.iterdir()] == ["state"]
    assert stat.S_ISREG(path.stat().st_mode)
