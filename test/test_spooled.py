"""Rows in a temporary file, and means over blocks of what is read from it in parts."""

import tempfile

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hgma_compensation.diagnosis.block_sums import BlockSums
from hgma_compensation.errors import RefusedError
from hgma_compensation.recording import spooled
from hgma_compensation.recording.spooled import Spooled


@given(counts=st.lists(st.integers(0, 9), max_size=8), most=st.none() | st.integers(0, 40))
def test_rows_come_back_in_their_order(counts, most):
    before, spooled.AT_ONCE = spooled.AT_ONCE, 4
    try:
        rows = np.random.default_rng(sum(counts)).standard_normal((sum(counts), 3))
        held = Spooled(3)
        for part in np.split(rows, np.cumsum(counts)[:-1]) if counts else []:
            held.add(part)
        assert len(held) == len(rows)
        assert np.concatenate([np.empty((0, 3)), *held.parts()]).tobytes() == rows.tobytes()
        assert held.column(1, most).tobytes() == rows[:most, 1].tobytes()
        assert all(len(part) <= 4 for part in held.parts())
    finally:
        spooled.AT_ONCE = before


def test_stamps_keep_their_last_bit():
    held = Spooled(1, np.int64)
    held.add(np.array([[1_600_000_000_000_000_001], [1_600_000_000_000_000_003]]))
    assert held.column(0).tolist() == [1_600_000_000_000_000_001, 1_600_000_000_000_000_003]


def test_a_place_that_cannot_hold_a_file_is_refused_with_the_remedy(monkeypatch, tmp_path):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "missing"))
    with pytest.raises(RefusedError, match=r"temporary files cannot hold one .*TMPDIR"):
        Spooled(2)


@given(
    count=st.integers(1, 50),
    cuts=st.lists(st.integers(0, 50), max_size=5),
    edges=st.lists(st.integers(0, 50), min_size=2, max_size=10, unique=True),
)
def test_means_over_blocks_do_not_depend_on_the_parts_that_samples_come_in(count, cuts, edges):
    samples = np.random.default_rng(count).standard_normal((count, 2)) * 1e3
    edges = np.array(sorted({min(edge, count) for edge in edges}))
    first, last = edges[:-1], edges[1:]
    sums = BlockSums(first, last, 2)
    for part in np.split(samples, sorted(min(cut, count) for cut in cuts)):
        sums.add(part)
    running = np.vstack([np.zeros(2), np.cumsum(samples, axis=0)])
    expected = (running[last] - running[first]) / (last - first)[:, None]
    assert sums.means().tobytes() == expected.tobytes()
    np.testing.assert_allclose(
        sums.means().reshape(-1, 2),
        np.array([samples[a:b].mean(axis=0) for a, b in zip(first, last, strict=True)]).reshape(-1, 2),
        atol=1e-9,
    )
