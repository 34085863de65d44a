import json
from dataclasses import replace

import pytest
from builders import make_calibration, make_rbf
from hypothesis import given
from hypothesis import strategies as st

from hgma_compensation import json_text
from hgma_compensation.calibration.document import LARGEST_FILE, MOST_COMMAS, with_id
from hgma_compensation.calibration.encoding import encode
from hgma_compensation.channels import CHANNELS

DOCUMENTS = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.text(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
    max_leaves=30,
)


def outcome(text, before=0):
    """Return what comes of a text after spaces: the document, with the types of numbers, or the error's words."""
    try:
        return repr(json_text.parse(" " * before + text, object_pairs=list, constant=str.lower))
    except json.JSONDecodeError as error:
        return error.msg, error.pos - before


@given(DOCUMENTS, st.data())
def test_a_long_text_is_read_and_refused_as_a_short_one(document, data):
    text = json.dumps(document, indent=data.draw(st.sampled_from([None, 1])), ensure_ascii=data.draw(st.booleans()))
    cut = data.draw(st.integers(0, len(text)))
    for part in (text, text[:cut], text[:cut] + "," + text[cut:]):
        assert outcome(part) == outcome(part, before=json_text.AT_ONCE)


@given(DOCUMENTS)
def test_the_canonical_text_is_that_of_the_encoder_in_c(document):
    assert json_text.canonical(document) == json.dumps(document, sort_keys=True, separators=(",", ":"))


@pytest.mark.parametrize("number", [float("nan"), float("inf")])
def test_there_is_no_canonical_text_of_what_is_no_number(number):
    with pytest.raises(ValueError, match="not JSON compliant"):
        json_text.canonical({"a": [number]})


def test_the_largest_calibration_fits_into_a_file_with_margin():
    calibration = make_calibration(channels=CHANNELS)
    channels = tuple(replace(channel, drift=make_rbf(centres=500)) for channel in calibration.channels)
    document = encode(with_id(replace(calibration, channels=channels)))
    effect = {"effect": "e", "channel": CHANNELS[0], "parameters": dict.fromkeys("abcdefghij", -0.12345678901234567)}
    document["effects"] = [{**effect, "gains": [-0.12345678901234567] * 64}] * 64
    document["training"]["recordings"] *= 1000
    text = json.dumps(document, indent=1)
    assert 0.5 * LARGEST_FILE < len(text) < 0.95 * LARGEST_FILE
    assert 0.3 * MOST_COMMAS < text.count(",") < 0.8 * MOST_COMMAS
