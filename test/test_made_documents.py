"""Each effect has a page whose tables are those of its class, and a picture that a command draws."""

import re
from pathlib import Path

import numpy as np
import pytest

from benchmarks.pictures import effect_picture, effect_tables, packages
from benchmarks.pictures.marks import write_between_marks
from benchmarks.pictures.scenarios import SCENARIOS, show
from hgma_compensation.effects.registry import kinds
from hgma_compensation.errors import RefusedError

ROOT = Path(__file__).parents[1]
DOCUMENTS = ROOT / "docs"
EACH = pytest.mark.parametrize("name", sorted(SCENARIOS))


def test_every_page_has_an_effect_a_scenario_and_a_picture():
    # Not the other way round: a new effect is one file, and its page may come later.
    assert set(SCENARIOS) <= set(kinds())
    assert {path.stem for path in (DOCUMENTS / "effects").iterdir()} == set(SCENARIOS)
    assert {path.stem for path in (DOCUMENTS / "images" / "effects").iterdir()} == set(SCENARIOS)


@EACH
def test_tables_of_a_page_are_those_of_the_class(name):
    page = (DOCUMENTS / "effects" / f"{name}.md").read_text(encoding="utf-8")
    assert effect_tables.table(kinds()[name]) in page


@EACH
def test_the_scenario_shows_the_effect(name):
    shown = show(name)
    assert np.ptp(shown.drift) > 5.0  # m/s², of pictures that are drawn to the size of what is in them


def test_a_picture_is_drawn(tmp_path):
    path = tmp_path / "new" / "thermal_lag.png"
    effect_picture.draw("thermal_lag", show("thermal_lag"), path)
    assert path.read_bytes().startswith(b"\x89PNG")
    assert path.stat().st_size > 10_000


def test_pages_without_marks_are_refused(tmp_path):
    page = tmp_path / "aging.md"
    page.write_text("# Aging\n", encoding="utf-8")
    with pytest.raises(RefusedError, match="lacks the marks"):
        write_between_marks(page, "new")
    assert page.read_text(encoding="utf-8") == "# Aging\n"


def test_every_picture_is_made_by_a_command_and_shown():
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    drawn = {f"docs/images/effects/{name}.png" for name in SCENARIOS} | set(
        re.findall(r"docs/images/[\w/.]+", makefile)
    )
    there = {path.relative_to(ROOT).as_posix() for path in (DOCUMENTS / "images").rglob("*.*")}
    assert there == drawn
    texts = [path.read_text(encoding="utf-8") for path in (ROOT / "README.md", *DOCUMENTS.rglob("*.md"))]
    for picture in there:
        assert any(picture.removeprefix("docs/") in text for text in texts), picture


def test_the_table_of_packages_is_that_of_the_sources():
    text = (DOCUMENTS / "ARCHITECTURE.md").read_text(encoding="utf-8")
    assert packages.table() in text, "make pictures writes it anew"


LAYERS = (
    {"drift", "effects", "kalman", "temperature", "cdr"},
    {"calibration"},
    {"pipeline"},
    {"recording", "loading"},
)
"""What the node runs on, bottom first: a layer imports its own and those below, never the tools above."""


def test_layers_import_downwards_only():
    below = set()
    for layer in LAYERS:
        below |= layer
        for package in layer:
            assert packages.imported(package) <= below, package
