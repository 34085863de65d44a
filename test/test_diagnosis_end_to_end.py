"""A small part of the loop benchmark: half an hour a recording, a short search for the network."""

import pytest

from benchmarks.loop.cases import EFFECTS, PAIRS
from benchmarks.loop.worker import Task, run

SHORT, SEARCH = 0.5, 20


def outcome_of(group, index, seed, generator, hours=SHORT):
    outcome = run(Task(group, index, seed, generator, SEARCH, hours))
    assert not outcome.failure
    return outcome


@pytest.mark.parametrize(
    ("name", "seed", "generator"),
    [
        ("supply_voltage", 1, "project"),
        ("thermal_lag", 1, "project"),
        ("thermal_gradient", 2, "project"),
        ("cross_axis", 1, "other"),
    ],
)
def test_an_effect_is_named_and_taken_away(name, seed, generator):
    outcome = outcome_of("single", EFFECTS.index(name), seed, generator)
    assert (outcome.verdict, outcome.named) == ("explained", (name,))
    assert outcome.p_values[0] < 0.002
    assert outcome.after < 0.4 * outcome.before
    assert outcome.after < 1.5 * outcome.oracle
    # What it says of itself is true.
    assert outcome.claimed_after == pytest.approx(outcome.after, rel=0.3)


def test_two_effects_are_named_and_taken_away():
    truth = ("thermal_lag", "supply_voltage")
    outcome = outcome_of("pairs", PAIRS.index(truth), 2, "project")
    assert outcome.verdict == "explained"
    assert sorted(outcome.named) == sorted(truth)
    assert outcome.after < 1.3 * outcome.oracle < 0.6 * outcome.before


def test_where_there_is_no_effect_none_is_named():
    outcome = outcome_of("none", 0, 1, "project", hours=1.0)
    assert (outcome.verdict, outcome.named) == ("no_effect", ())
    assert outcome.after == outcome.before


@pytest.mark.parametrize(
    ("structure", "index", "generator"),
    [("humidity", 2, "project"), ("telegraph_noise", 1, "other")],
)
def test_structure_that_no_effect_has_is_unexplained(structure, index, generator):
    outcome = outcome_of("unknown", index, 1, generator)
    assert outcome.truth == (structure,)
    assert (outcome.verdict, outcome.named) == ("unexplained", ())
    assert outcome.after <= outcome.before
