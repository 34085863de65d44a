"""YAML and tables that are small and stand for much, do not end, or are no text."""

import os
import random

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from refusals import refusal_of
from simulation_scenarios import PARAMS

from benchmarks.soak.fuzz import text_mutations, tree_mutations
from hgma_compensation import plain_yaml
from hgma_compensation.bounded_files import LONGEST_LINE
from hgma_compensation.errors import RefusedError
from hgma_compensation.plain_yaml import LONGEST_NUMBER, MOST_VALUES, load_plain
from hgma_compensation.recording.csv_columns import read_columns
from hgma_compensation.simulation.scenario import LARGEST_FILE, read_scenario

SCENARIOS = [path.read_text() for path in sorted(PARAMS.glob("*oven_test.yaml"))]
LAUGHS = "a0: &a0 [x]\n" + "".join(f"a{n + 1}: &a{n + 1} [{', '.join([f'*a{n}'] * 9)}]\n" for n in range(12))
MERGES = "a0: &a0 {k: v}\n" + "".join(f"a{n + 1}: &a{n + 1} {{<<: [{', '.join([f'*a{n}'] * 9)}]}}\n" for n in range(12))


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (LAUGHS, f"line [0-9]+: its aliases stand for more than {MOST_VALUES} values: write them out"),
        (MERGES, f"line [0-9]+: its aliases stand for more than {MOST_VALUES} values: write them out"),
        ("a: &a [*a]", "line 1: an alias stands for what contains it: write it out"),
        ("a: " + "1" * (LONGEST_NUMBER + 1), "line 1: a number has 61 digits: shorten it"),
        ("[" * 100_000, "is nested too deeply|is no YAML"),
        ("a: !!python/object/apply:os.getcwd []", "is no plain map or list: remove the tag"),
        ("a: !!python/name:os.system", "is no number or text: put it in quotes"),
        ("a: 2020-01-01", "'2020-01-01' is no number or text: put it in quotes"),
        ("a: 1\n---\nb: 2", "is no YAML"),
        ("a: \x00", "is no YAML"),
    ],
)
def test_yaml_that_is_more_than_plain_data_of_a_sane_size_is_refused(text, reason):
    with pytest.raises(RefusedError, match=reason):
        load_plain(text)


def test_yaml_of_more_values_than_are_allowed_is_refused(monkeypatch):
    monkeypatch.setattr(plain_yaml, "MOST_VALUES", 100)
    with pytest.raises(RefusedError, match="has more than 100 values: make it shorter"):
        load_plain("- 1\n" * 100)
    assert load_plain("- 1\n" * 99) == [1] * 99


def test_aliases_and_merge_keys_of_a_sane_size_are_read():
    assert load_plain("a: &a {k: 1}\nb: {<<: *a, l: 2.5}\nc: [*a, *a]") == {
        "a": {"k": 1},
        "b": {"k": 1, "l": 2.5},
        "c": [{"k": 1}, {"k": 1}],
    }


@pytest.fixture
def odd_files(tmp_path):
    """Files that are no tables and no scenarios, by name."""
    os.mkfifo(tmp_path / "pipe")
    with open(tmp_path / "zeros", "wb") as file:
        file.truncate(1 << 40)
    (tmp_path / "latin").write_bytes(b"t,a\n0,\xff\n")
    (tmp_path / "zero").symlink_to("/dev/zero")
    return tmp_path


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("pipe", "is not a regular file"),
        ("zero", "is not a regular file"),
        ("zeros", f"is larger than {LARGEST_FILE} bytes"),
        ("latin", "is not UTF-8 text"),
    ],
)
def test_a_scenario_that_blocks_has_no_end_or_is_no_text_is_refused(odd_files, name, reason):
    with pytest.raises(RefusedError, match=reason):
        read_scenario(odd_files / name)


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("pipe", "is not a regular file"),
        ("zero", "is not a regular file"),
        ("zeros", f"has a line of {LONGEST_LINE} characters or more"),
        ("latin", "cannot be read as a CSV table"),
    ],
)
def test_a_table_that_blocks_has_no_end_or_is_no_text_is_refused(odd_files, name, reason):
    with pytest.raises(RefusedError, match=reason):
        read_columns(odd_files / name, {"time": "t"})


def test_a_table_of_more_rows_than_are_allowed_is_refused(tmp_path):
    (tmp_path / "long.csv").write_text("t\n" + "1\n" * 11)
    with pytest.raises(RefusedError, match="has more than 10 rows: cut it into parts"):
        read_columns(tmp_path / "long.csv", {"time": "t"}, most_rows=10)


def mutant(seed):
    """Return a scenario that is damaged in its tree or in its text."""
    chance = random.Random(seed)
    text, other = chance.choice(SCENARIOS), chance.choice(SCENARIOS)
    if chance.random() < 0.5:
        return text_mutations.mutate(text.encode(), other.encode(), chance)
    tree = yaml.safe_load(text)
    tree_mutations.mutate(tree, yaml.safe_load(other), chance)
    return yaml.safe_dump(tree, allow_unicode=True).encode(errors="surrogatepass")


@settings(max_examples=150)
@given(seed=st.integers(0, 2**32))
def test_a_damaged_scenario_is_read_or_refused_with_its_name(tmp_path_factory, seed):
    path = tmp_path_factory.getbasetemp() / "damaged.yaml"
    path.write_bytes(mutant(seed))
    assert str(path) in (refusal_of(read_scenario, path) or str(path))


@settings(max_examples=200)
@given(seed=st.integers(0, 2**32))
def test_a_damaged_table_is_read_or_refused_with_its_name(tmp_path_factory, seed):
    path = tmp_path_factory.getbasetemp() / "damaged.csv"
    table = "t,a\n" + "".join(f"{n},{n * 0.5}\n" for n in range(20))
    path.write_bytes(text_mutations.mutate(table.encode(), b'"t",\x00\n1e999,-inf\r1_0', random.Random(seed)))
    assert str(path) in (refusal_of(read_columns, path, {"time": "t", "value": "a"}) or str(path))
