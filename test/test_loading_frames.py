import io
import subprocess
import sys

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hgma_compensation.loading.frames import Incoming, framed, read_frame

NOISY = """
import os, sys
from hgma_compensation.loading import child
def answer(request):
    print("a library's greeting", flush=True)
    os.system("echo greeting of a program")
    return [request, request]
child.answer = answer
sys.exit(child.main())
"""


@given(st.lists(st.binary(max_size=300), min_size=1, max_size=3), st.integers(1, 400))
def test_an_object_is_whole_whatever_the_pieces_it_comes_in(message, size):
    content, incoming = framed(message), Incoming()
    for start in range(0, len(content), size):
        assert not incoming.complete
        incoming.feed(content[start : start + size])
    assert incoming.complete
    assert incoming.message() == message
    file = io.BytesIO(content * 2)
    assert [read_frame(file), read_frame(file)] == [message, message]


@pytest.mark.parametrize("count", [0, 3, 12])
def test_a_pipe_that_is_closed_is_the_end_also_within_an_object(count):
    with pytest.raises(EOFError):
        read_frame(io.BytesIO(framed("a calibration")[:count]))


def test_what_is_printed_goes_beside_the_answers():
    child = subprocess.run(
        [sys.executable, "-c", NOISY], input=framed(1) + framed(2), capture_output=True, timeout=60.0, check=True
    )
    assert child.stdout == framed([1, 1]) + framed([2, 2])
    assert child.stderr.decode().count("greeting") == 4
