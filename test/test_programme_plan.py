import json
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from refusals import refusal_of
from test_cli import refused
from test_cli import run as hgma

from hgma_compensation.effects.registry import kinds
from hgma_compensation.programme import rules
from hgma_compensation.programme.activities import OFF
from hgma_compensation.programme.plan import plan, rates, soak_for
from hgma_compensation.programme.programme import Wishes
from hgma_compensation.programme.rules import DEMANDS, Activity, demand_of
from hgma_compensation.programme.steps import Part

EFFECTS = st.lists(st.sampled_from(sorted(kinds())), unique=True).map(tuple)


@st.composite
def wishes(draw, hours=None):
    lowest = draw(st.floats(-100.0, 100.0))
    return Wishes(
        effects=draw(EFFECTS),
        lowest=lowest,
        highest=lowest + draw(st.floats(rules.LEAST_SPAN + 0.001, 150.0)),
        ramp_rate=draw(st.floats(0.1, 50.0)),
        mission_rate=draw(st.floats(0.1, 50.0)),
        time_constant=draw(st.none() | st.floats(1.0, 1e4)),
        hours=None if hours is None else draw(hours),
    )


@given(wishes())
def test_every_step_is_one_that_the_oven_can_do(wished):
    made = plan(wished)
    for step in made.steps:
        assert wished.lowest <= step.start <= wished.highest
        assert wished.lowest <= step.to <= wished.highest
        assert 0.0 < step.rate <= wished.ramp_rate
        assert step.soak >= rules.LEAST_SOAK
        assert step.duration == abs(step.to - step.start) / step.rate + step.soak
    for before, after in zip(made.steps, made.steps[1:], strict=False):
        assert after.start == before.to


@given(wishes())
def test_the_whole_is_the_sum_of_its_steps(wished):
    made = plan(wished)
    assert made.duration == sum(step.duration for step in made.steps)
    assert made.starts[0] == 0.0
    assert made.starts[-1] + made.steps[-1].duration == pytest.approx(made.duration)


@given(wishes())
def test_the_hold_out_comes_last_inside_what_is_learned_at_a_rate_between(wished):
    made = plan(wished)
    parts = [step.part for step in made.steps]
    first = parts.index(Part.HOLD_OUT)
    assert set(parts[:first]) == {Part.LEARN}
    assert set(parts[first:]) == {Part.HOLD_OUT}
    assert made.hold_out == made.starts[first]
    slow, fast = rates(wished, made.effects)[:2]
    for step in made.steps[first:]:
        assert slow < step.rate < fast
    learned = [step.to for step in made.steps[:first]]
    assert min(learned) < min(step.to for step in made.steps[first:])
    assert max(learned) > max(step.to for step in made.steps[first:])


@given(wishes())
def test_two_cycles_at_two_rates_are_learned_from(wished):
    made = plan(wished)
    ends = [(s.to, s.rate) for s in made.steps if s.part is Part.LEARN]
    cold = {rate for to, rate in ends if to == wished.lowest}
    hot = {rate for to, rate in ends if to == wished.highest}
    assert cold == hot == set(rates(wished, made.effects))
    assert max(cold) == pytest.approx(rules.RATIO * sorted(cold)[-2])


@given(wishes())
def test_rates_bracket_the_mission_or_it_is_said(wished):
    made = plan(wished)
    fastest = max(step.rate for step in made.steps if step.part is Part.LEARN)
    assert fastest >= wished.mission_rate or any("mission" in note for note in made.notes)


@given(wishes())
def test_happenings_lie_in_order_inside_the_programme(wished):
    made = plan(wished)
    times = [one.time for one in made.happenings]
    assert times == sorted(times)
    for one in made.happenings:
        assert 0.0 < one.time < one.time + one.duration < 60.0 * made.duration or one.duration == 0.0
        assert abs(one.size) <= 1.0
    done = {one.activity for one in made.happenings}
    assert done == {demand_of(name).activity for name in made.effects} - {None}


@given(wishes())
def test_nothing_else_happens_while_the_power_is_off(wished):
    made = plan(wished)
    for pause in (one for one in made.happenings if one.activity is Activity.POWER):
        assert pause.duration <= OFF
        for other in made.happenings:
            inside = pause.time <= other.time < pause.time + pause.duration
            assert other is pause or not inside


@given(wishes(hours=st.floats(0.5, 60.0)))
def test_hours_are_kept_and_what_is_dropped_is_named(wished):
    refusal = refusal_of(plan, wished)
    if refusal is not None:
        least = plan(replace(wished, effects=(), hours=None)).duration
        assert "--hours" in refusal
        assert least > 60.0 * wished.hours
        return
    made = plan(wished)
    assert made.duration <= 60.0 * wished.hours + 1e-6
    names = [one.name for one in made.dropped]
    assert sorted([*made.effects, *names]) == sorted(wished.effects)
    assert all(one.hours > 0.0 for one in made.dropped)


def test_no_more_is_dropped_than_must_be():
    everything = tuple(kinds())
    whole = plan(Wishes(effects=everything)).duration / 60.0
    one_less = plan(Wishes(effects=everything, hours=whole - 0.1))
    assert len(one_less.dropped) == 1
    assert plan(Wishes(effects=everything, hours=whole + 0.1)).dropped == ()


def test_a_known_time_constant_makes_the_soaks():
    known = Wishes(effects=("stress_relaxation",), time_constant=6000.0)
    assert soak_for(known, known.effects) == (pytest.approx(150.0), "stress_relaxation")
    assert soak_for(Wishes(effects=("supply_voltage",), time_constant=6000.0), ("supply_voltage",))[0] == 15.0


def test_demands_are_of_effects_and_have_a_reason():
    # Not the other way round: a new effect is one file, and its own words stand in for a demand until there is one.
    assert set(DEMANDS) <= set(kinds())
    assert all(demand.why for demand in DEMANDS.values())


def test_the_command_says_what_the_plan_is(tmp_path, capsys):
    arguments = ("--effects", "warm_up,aging", "--hours", "12", "--json", tmp_path / "p.json")
    assert hgma("plan", *arguments) == 0
    figures = json.loads((tmp_path / "p.json").read_text())
    assert figures["effects"] == ["warm_up"]
    assert list(figures["dropped"]) == ["aging"]
    assert figures["duration_min"] == pytest.approx(sum(step["duration_min"] for step in figures["steps"]))
    printed = capsys.readouterr().out
    assert "dropped: aging" in printed
    assert "switch the sensor off" in printed
    assert f"--until {figures['hold_out_from_s']:.0f}" in printed


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--effects", "moonlight"], "moonlight"),
        (["--effects", ","], "no effect is named"),
        (["--from", "20", "--to", "10"], "--from 20 --to 10"),
        (["--hours", "1"], "--hours 1"),
        (["--ramp-rate", "0"], "ramp-rate"),
        (["--ramp-rate", "nan"], "ramp-rate"),
        (["--time-constant", "-5"], "time-constant"),
        (["--json", "nowhere/plan.json"], "nowhere"),
    ],
)
def test_mistakes_are_refused_with_the_option(words, said, capsys):
    assert said in refused(capsys, "plan", *words)
