"""Ratios, verdicts, table and document of the benchmark."""

import json

import pytest

from benchmarks.bench import __main__ as bench
from benchmarks.bench import filtering
from benchmarks.bench.__main__ import GROUPS, figures, main
from benchmarks.bench.document import BEGIN, END, generated, update, with_generated
from benchmarks.bench.row import Result, Row, Target, alternate
from benchmarks.bench.table import cells, markdown_table, number


def row(ours, rival, target=None, note=""):
    return Row("group", "name", "s", "somebody", tuple(ours), tuple(rival), target, note)


def test_the_ratio_is_the_median_of_those_of_each_repetition():
    # Ours and the rival slow down together in the last one: the ratio of their medians would be 2.
    measured = row([1.0, 4.0, 30.0], [1.0, 2.0, 10.0])
    assert measured.ratios == (1.0, 2.0, 3.0)
    assert measured.ratio == 2.0
    assert row([1.0, 3.0, 9.0], [1.0, 1.0, 90.0]).ratio == 1.0


@pytest.mark.parametrize(
    ("target", "ratio", "verdict"),
    [
        (Target(1.5), 1.5, "met"),
        (Target(1.5), 1.51, "missed"),
        (Target(15.0, at_least=True), 15.0, "met"),
        (Target(15.0, at_least=True), 14.9, "missed"),
        (None, 1.0, ""),
    ],
)
def test_the_verdict_is_that_of_the_median(target, ratio, verdict):
    assert row([ratio] * 3, [1.0] * 3, target).verdict == verdict
    assert row([ratio, 1e-9, 1e9], [1.0] * 3, target).verdict == verdict


def test_a_repetition_that_one_side_lacks_is_no_ratio():
    with pytest.raises(ValueError, match="zip"):
        _ = row([1.0, 2.0], [1.0]).ratios


def test_both_sides_are_measured_by_turns():
    calls = []

    def side(name, value):
        calls.append(name)
        return value + len(calls)

    figures = alternate(3, lambda: side("ours", 10.0), lambda: side("rival", 20.0))
    assert calls == ["ours", "rival"] * 3
    assert figures == ((11.0, 13.0, 15.0), (22.0, 24.0, 26.0))


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.0, "0"), (12345.6, "12300"), (0.01234, "0.0123"), (9.996, "10"), (1.5e-5, "1.5e-05"), (3.2e7, "3.2e+07")],
)
def test_numbers_have_three_digits(value, text):
    assert number(value) == text


def test_a_line_of_the_table_shows_medians_spread_target_and_verdict():
    line = cells(row([1.0, 4.0, 30.0], [1.0, 2.0, 10.0], Target(1.5), "as seen"))
    assert line == ("group: name [as seen]", "s", "4", "2", "somebody", "2 (1 to 3)", "≤ 1.5", "missed")


def test_markdown_has_a_line_for_each_row():
    text = markdown_table([row([1.0], [1.0]), row([2.0], [1.0])])
    lines = text.splitlines()
    assert len(lines) == 4
    assert len({line.count("|") for line in lines}) == 1


def test_only_the_part_between_the_marks_is_replaced(tmp_path):
    path = tmp_path / "document.md"
    path.write_text(f"before\n{BEGIN}\nold\n{END}\nafter\n", encoding="utf-8")
    for _ in range(2):
        update(path, [row([1.0], [2.0])], {"cores": "2"})
    text = path.read_text(encoding="utf-8")
    assert text.startswith(f"before\n{BEGIN}\n")
    assert text.endswith(f"{END}\nafter\n")
    assert "old" not in text
    assert text.count("| cores | 2 |") == text.count("group: name") == 1


@pytest.mark.parametrize("text", ["", BEGIN, END, f"{END}{BEGIN}", f"{BEGIN}{END}{BEGIN}{END}", f"{BEGIN}{BEGIN}{END}"])
def test_a_document_without_its_marks_is_left_alone(text):
    with pytest.raises(ValueError, match="once each"):
        with_generated(text, "part")


def test_the_json_has_every_repetition_and_the_details():
    result = Result((row([1.0, 3.0, 2.0], [1.0, 1.0, 1.0], Target(2.0)),), {"trials": [1]})
    document = json.loads(json.dumps(figures({"group": result}, {"cores": "2"})))
    (line,) = document["rows"]
    assert line["ours"] == line["ratios"] == [1.0, 3.0, 2.0]
    assert (line["ratio"], line["verdict"]) == (2.0, "met")
    assert document["details"] == {"group": {"trials": [1]}}
    assert document["machine"] == {"cores": "2"}


@pytest.mark.parametrize(
    "arguments", [["nothing"], ["--repetitions", "2"], ["messages", "--write-docs"]], ids=lambda words: words[0]
)
def test_arguments_that_make_no_sense_are_refused(arguments, capsys):
    with pytest.raises(SystemExit) as refused:
        main(arguments)
    assert refused.value.code == 2
    assert "Traceback" not in capsys.readouterr().err


def test_every_group_is_a_module():
    from importlib.util import find_spec

    assert all(find_spec(f"benchmarks.bench.{name}") for name in GROUPS)


def test_what_is_generated_names_the_machine_below_the_table():
    text = generated([row([1.0], [1.0])], {"processor": "some"})
    assert text.index("group: name") < text.index("| processor | some |")


@pytest.fixture
def _quick(monkeypatch, tmp_path):
    """The whole command on one group of a few samples, in a folder of its own."""
    monkeypatch.setattr(filtering, "OURS", 2000)
    monkeypatch.setattr(filtering, "RIVALS", 50)
    monkeypatch.setattr(bench, "GROUPS", ("filtering", "start"))
    monkeypatch.setattr(bench, "BAGS", tmp_path / "bags")
    monkeypatch.setattr(bench, "DOCUMENT", tmp_path / "document.md")
    monkeypatch.setattr(bench, "private_ros_environment", dict)
    bench.DOCUMENT.write_text(f"{BEGIN}{END}", encoding="utf-8")


@pytest.mark.usefixtures("_quick")
def test_a_group_that_fails_leaves_the_others_and_the_document_alone(monkeypatch, tmp_path, capsys):
    def fails(name):
        if name.endswith("start"):
            raise RuntimeError("does not answer")
        return filtering

    monkeypatch.setattr(bench, "import_module", fails)
    assert main(["--write-docs", "--json", str(tmp_path / "figures.json"), "--repetitions", "3"]) == 1
    said = capsys.readouterr()
    assert "start: does not answer" in said.err
    assert "not measured: start" in said.out
    assert bench.DOCUMENT.read_text(encoding="utf-8") == f"{BEGIN}{END}"
    document = json.loads((tmp_path / "figures.json").read_text())
    assert [line["group"] for line in document["rows"]] == ["filtering"]


@pytest.mark.usefixtures("_quick")
def test_a_run_of_all_groups_is_written_into_the_document(monkeypatch):
    monkeypatch.setattr(bench, "GROUPS", ("filtering",))
    main(["--write-docs", "--repetitions", "3"])
    text = bench.DOCUMENT.read_text(encoding="utf-8")
    assert "filtering: smooth" in text
    assert "| cores |" in text
    assert list(bench.BAGS.iterdir()) == []
