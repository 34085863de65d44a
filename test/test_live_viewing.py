"""What plotting tools are told to show exists: the Foxglove layout and the rqt_plot lines of the documents."""

import json
import re
from pathlib import Path

import pytest
from message_paths import TYPES, field_type

ROOT = Path(__file__).parents[1]
LAYOUT = json.loads((ROOT / "launch" / "foxglove_layout.json").read_text(encoding="utf-8"))
PANELS = {"Plot", "StateTransitions", "RawMessages", "DiagnosticSummary", "DiagnosticStatusPanel"}
PATHS = [path["value"] for panel in LAYOUT["configById"].values() for path in panel.get("paths", ())]
LINES = [
    line
    for document in [ROOT / "README.md", *(ROOT / "docs").rglob("*.md")]
    for line in re.findall(r"^rqt_plot .+$", document.read_text(encoding="utf-8"), re.MULTILINE)
]
NUMBERS = r"(float|u?int)\d+|bool"


def leaves(tree):
    if isinstance(tree, str):
        return [tree]
    assert tree["direction"] in ("row", "column")
    return leaves(tree["first"]) + leaves(tree["second"])


def test_every_panel_has_its_place_and_every_place_its_panel():
    assert sorted(leaves(LAYOUT["layout"])) == sorted(LAYOUT["configById"])
    assert {name.partition("!")[0] for name in LAYOUT["configById"]} == PANELS


@pytest.mark.parametrize("path", PATHS)
def test_a_path_of_the_layout_is_a_field_of_a_topic_of_the_node(path):
    topic, _, fields = path.partition(".")
    assert re.fullmatch(NUMBERS + "|string", field_type(topic, fields))


def test_plots_show_numbers_and_the_diagnostics_their_topic():
    for name, panel in LAYOUT["configById"].items():
        if name.startswith("Plot!"):
            for path in panel["paths"]:
                topic, _, fields = path["value"].partition(".")
                assert re.fullmatch(NUMBERS, field_type(topic, fields))
        elif not name.startswith("StateTransitions!"):
            assert panel.get("topicToRender", panel.get("topicPath")) in TYPES


def test_the_fields_that_rqt_plot_is_given_are_numbers():
    assert LINES
    for line in LINES:
        for field in line.split("#")[0].split()[1:]:
            topic = next(topic for topic in sorted(TYPES, key=len, reverse=True) if field.startswith(f"{topic}/"))
            kind = field_type(topic, field.removeprefix(f"{topic}/").replace("/", "."))
            assert re.fullmatch(NUMBERS, kind), field
