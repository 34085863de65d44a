import ast
import copy
import re

import numpy as np
import pytest
from builders import LINEAR, make_calibration
from hypothesis import given, settings
from hypothesis import strategies as st
from jsonschema import Draft202012Validator

from hgma_compensation.calibration.encoding import encode
from hgma_compensation.effects.applied import AppliedEffect
from hgma_compensation.effects.registry import make
from hgma_compensation.errors import RefusedError
from hgma_compensation.kalman.settings import FilterMode
from hgma_compensation.schema_check import check, load_schema

SCHEMA = load_schema("hgma_compensation.calibration", "calibration.schema.json")
VALIDATOR = Draft202012Validator(SCHEMA)
MESSAGE = re.compile(
    r"(?P<path>the document|[a-z_]+(?:\.[a-z_][a-z0-9_]*|\[\d+\])*) (?:lacks the field '(?P<missing>\w+)'.*"
    r"|has the unknown field (?P<unknown>.+)|has \d+ (?:elements|characters|fields), must have .+"
    r"|is .+, must (?:be|match) .+|must be an object)"
)


def document_of(calibration):
    return {**encode(calibration), "calibration_id": calibration.calibration_id}


EFFECTS = [
    AppliedEffect(LINEAR[2], make("stress_relaxation", {"time_constant": 900.0, "spread": 3.0}), np.ones(3)),
    AppliedEffect(LINEAR[2], make("cross_axis", {"source": LINEAR[0]}), np.ones(1)),
]
DOCUMENTS = [
    document_of(make_calibration(channels=LINEAR[:2])),
    document_of(make_calibration(method="polynomial", channels=LINEAR[2:], mode=FilterMode.SMOOTH)),
    document_of(make_calibration(method="polynomial", channels=LINEAR[2:], effects=EFFECTS)),
]
ID = "sha256-" + "0" * 16
SCALARS = st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.text()
NEAR = [True, False, 0, 1, -1, 1.0, 2.5, 0.0, 1e300, "", "rbf", "polynomial", "off", "smooth", "x" * 201, [], {}, None]
VALUES = st.sampled_from(NEAR) | st.recursive(
    SCALARS, lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(), inner, max_size=3), max_leaves=4
)


def places(value, path=()):
    """Yield the path of every value in a document."""
    yield path
    if isinstance(value, (dict, list)):
        for key, child in value.items() if isinstance(value, dict) else enumerate(value):
            yield from places(child, (*path, key))


def at(document, path):
    for key in path:
        document = document[key]
    return document


@st.composite
def mutated(draw):
    document = copy.deepcopy(draw(st.sampled_from(DOCUMENTS)))
    values = VALUES.map(copy.deepcopy)  # a later change must not alter what is drawn next
    for _ in range(draw(st.integers(1, 3))):
        path = draw(st.sampled_from(list(places(document))))
        value, change = at(document, path), draw(st.sampled_from(["replace", "delete", "resize"]))
        if change == "replace" and path:
            at(document, path[:-1])[path[-1]] = draw(values)
        elif change == "delete" and path:
            del at(document, path[:-1])[path[-1]]
        elif isinstance(value, dict):
            value[draw(st.text() | st.sampled_from(["note", "method", "mode", "delay_2"]))] = draw(values)
        elif isinstance(value, list):
            value[:] = (value * 600)[: draw(st.sampled_from([0, 1, 2, 4, 7, 101, 501]))] or [draw(values)]
    return document


def verdicts(document):
    """Return our refusal, None where there is none, and the paths of all errors that jsonschema finds."""
    found, stack = set(), list(VALIDATOR.iter_errors(document))
    while stack:
        error = stack.pop()
        found.add(tuple(error.absolute_path))
        stack.extend(error.context)
    try:
        check(document, SCHEMA)
    except RefusedError as refusal:
        return str(refusal), found
    return None, found


def path_of(text):
    if text == "the document":
        return ()
    return tuple(int(index) if index else name for name, index in re.findall(r"([a-z_][a-z0-9_]*)|\[(\d+)\]", text))


@settings(max_examples=400)
@given(document=mutated())
def test_verdict_is_that_of_jsonschema_and_names_one_of_its_paths(document):
    refusal, paths = verdicts(document)
    assert (refusal is None) == (not paths)
    if refusal is None:
        return
    assert len(refusal.splitlines()) == 1
    named = MESSAGE.fullmatch(refusal)
    assert named
    path = path_of(named["path"])
    assert path in paths
    if named["missing"]:
        assert named["missing"] not in at(document, path)
    if named["unknown"] and not named["unknown"].endswith("..."):
        assert ast.literal_eval(named["unknown"]) in at(document, path)


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (path, value)
        for path in [
            ("version",),
            ("calibration_id",),
            ("sensor_id",),
            ("effects",),
            ("training", "seed"),
            ("training", "recordings", 0, "start"),
            ("features", "delay"),
            ("features", "latency"),
            ("features", "product"),
            ("channels", 0, "error", "cross_validated"),
            ("channels", 0, "drift", "method"),
            ("channels", 0, "drift", "exponents", 0, 0),
            ("channels", 0, "filter", "white_noise"),
            ("effects", 0, "effect"),
            ("effects", 0, "channel"),
            ("effects", 0, "gains"),
            ("effects", 0, "gains", 0),
            ("effects", 0, "parameters"),
            ("effects", 0, "parameters", "time_constant"),
            ("effects", 0, "parameters", "time_constant\n"),
            ("effects", 0, "parameters", "Upper"),
        ]
        for value in [*NEAR, 9, 9.0, 10, 86400, 86400.5, 10**400, -(10**400), ID, ID + "\n", "s" * 200, "é" * 200]
    ],
)
def test_verdict_on_corners_is_that_of_jsonschema(path, value):
    document = copy.deepcopy(DOCUMENTS[2 if path[0] == "effects" else 1])
    at(document, path[:-1])[path[-1]] = value
    refusal, paths = verdicts(document)
    assert (refusal is None) == (not paths)


@pytest.mark.parametrize("document", [None, True, 1, "text", [], {}])
def test_what_is_no_calibration_at_all_is_refused(document):
    with pytest.raises(RefusedError, match=r"^the document "):
        check(document, SCHEMA)
