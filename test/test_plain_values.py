import pytest

from hgma_compensation.errors import RefusedError
from hgma_compensation.plain_values import DEEPEST, MOST_VALUES, check_plain


def nested(levels):
    document = 1.0
    for _ in range(levels):
        document = [document]
    return document


@pytest.mark.parametrize(
    ("document", "refusal"),
    [
        ({"a": [1.0, {"b": float("inf")}]}, "a[1].b is not finite"),
        ([float("nan")], "[0] is not finite"),
        ({"a": float("-inf"), "b": float("nan")}, "a is not finite"),
        ({"a": 10**400}, "a is not finite"),
        ({"a": "\ud800"}, "a holds characters that are no printable text"),
        ({"a": "red\x1b[31m"}, "a holds characters that are no printable text"),
        ({"a": "end\x00"}, "a holds characters that are no printable text"),
        ({"a": "left\u202eright"}, "a holds characters that are no printable text"),
        ({"a": {"b\n": 1}}, "a has a field whose name is no printable text"),
        ({1: 2}, "the document has a field whose name is no printable text"),
        ({"a": b"bytes"}, "a is a bytes, must be a number or a text"),
        ([[]] * MOST_VALUES, f"the document has more than {MOST_VALUES} values"),
        (nested(DEEPEST + 2), "[0]" * (DEEPEST + 1) + " is nested too deeply"),
    ],
)
def test_first_value_that_is_not_plain_is_named(document, refusal):
    with pytest.raises(RefusedError) as caught:
        check_plain(document)
    assert str(caught.value) == refusal


@pytest.mark.parametrize(
    "document", [[0] * (MOST_VALUES - 1), {"a": [1e308, -1, True, None, "NaN", "°C, µm, 温度"]}, nested(DEEPEST), {}]
)
def test_plain_document_is_accepted(document):
    check_plain(document)


def test_refusal_is_one_line_of_bounded_length_that_no_terminal_obeys():
    text = str(RefusedError("bad\n\x1b[31m\ud800" + "x" * 100_000 + ": take another"))
    assert len(text.splitlines()) == 1
    assert len(text) < 2000
    assert text.startswith("bad \ufffd[31m\ufffdxxx")
    assert text.endswith(": take another")
    assert text.isprintable()
