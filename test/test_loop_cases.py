import json
from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from benchmarks.loop import worker
from benchmarks.loop.__main__ import argument_parser, line_of, tasks_of
from benchmarks.loop.cases import (
    EFFECTS,
    GENERATORS,
    GROUPS,
    NEEDS,
    Case,
    items,
    make_case,
)
from benchmarks.loop.oracle import error_of, oracle_error, training_options
from benchmarks.loop.programme import HOURS, programme
from benchmarks.loop.score import Outcome, confusion, exact, false_alarm_rate, right_class, right_name, summarise
from benchmarks.loop.sizes import FLOOR, LARGEST, VISIBLE, VISIBLE_OF_TIMES, rms, whole
from benchmarks.loop.tables import headline, sheets
from hgma_compensation.stamps import NANOSECONDS
from hgma_compensation.training.train import train

SHORT = 0.1
"""h of a recording where its length does not matter."""

BRIEFEST = 0.03
"""h of a recording that must only exist."""

LONG_ENOUGH = 0.5 * HOURS
"""h of a recording in which effects have room for their size."""

every_generator = pytest.mark.parametrize("generator", GENERATORS)


def single(name: str, generator: str, hours: float = SHORT, group: str = "single", seed: int = 1) -> Case:
    return make_case(group, EFFECTS.index(name), seed, generator, hours)


def samples(case: Case) -> np.ndarray:
    parts = [[r.values.ravel(), r.temperature.values, r.temperature_2.values] for r in case.recordings]
    return np.concatenate([array for part in parts for array in part])


@every_generator
@pytest.mark.parametrize("group", GROUPS)
def test_every_item_of_every_group_can_be_made(group: str, generator: str) -> None:
    for index, item in enumerate(items(group, generator)):
        case = make_case(group, index, 1, generator, BRIEFEST)
        assert (case.truth, case.withheld) == (item.truth, item.withheld)
        assert len(case.training) == 3
        for recording, truth in zip(case.recordings, case.truths, strict=True):
            assert np.isfinite(recording.values).all()
            assert len(truth.effect) == len(truth.drift) == len(recording.stamps)


@every_generator
def test_the_same_arguments_give_the_same_samples_and_another_seed_or_index_others(generator: str) -> None:
    case = single("warm_up", generator)
    assert np.array_equal(samples(case), samples(single("warm_up", generator)))
    other_seed = single("warm_up", generator, seed=2)
    again = make_case("single", EFFECTS.index("warm_up") + len(EFFECTS), 1, generator, SHORT)
    for other in (other_seed, again):
        assert other.truth == case.truth
        assert not np.array_equal(other.true_drift_of_effect[0][:100], case.true_drift_of_effect[0][:100])


@every_generator
@pytest.mark.parametrize("name", ["warm_up", "supply_voltage", "thermal_gradient"])
def test_an_effect_is_of_the_size_promised(name: str, generator: str) -> None:
    case = single(name, generator, LONG_ENOUGH)
    assert VISIBLE[0] * 0.999 < worker.size_of(case) < VISIBLE[1] * 1.001
    assert rms(whole(case.true_drift_of_effect)) < LARGEST * FLOOR * 1.001


@every_generator
def test_a_delay_is_of_the_size_promised(generator: str) -> None:
    assert VISIBLE_OF_TIMES[0] < worker.size_of(single("timing_offset", generator, LONG_ENOUGH)) < VISIBLE_OF_TIMES[1]


@every_generator
@pytest.mark.parametrize("group", ["none", "thermistor_0.05"])
def test_an_effect_free_case_has_none(group: str, generator: str) -> None:
    for index in range(len(items(group, generator))):
        case = make_case(group, index, 1, generator, SHORT)
        assert not any(effect.any() for effect in case.true_drift_of_effect)
        assert case.truth == ()


@every_generator
def test_the_thermistor_is_as_noisy_as_promised(generator: str) -> None:
    for group, low, high in (("none", 0.02, 0.03), ("thermistor_0.05", 0.05, 0.05)):
        recording = make_case(group, 0, 1, generator, 2.0 * SHORT).training[0]
        noise = np.median(np.abs(np.diff(recording.temperature.values, 3))) / 0.6745 / np.sqrt(20.0)
        assert 0.9 * low < noise < 1.1 * high


@every_generator
def test_power_cycles_leave_gaps_without_samples_and_others_do_not(generator: str) -> None:
    for recording in single("warm_up", generator).recordings:
        gaps = np.diff(recording.stamps) / NANOSECONDS
        assert 1 <= np.sum(gaps > 10.0) <= 2
        assert np.diff(recording.temperature.stamps).max() / NANOSECONDS > 10.0
    for recording in make_case("none", 0, 1, generator, SHORT).recordings:
        assert np.diff(recording.stamps).max() / NANOSECONDS < 0.3


@every_generator
def test_recordings_follow_each_other_after_a_pause(generator: str) -> None:
    case = make_case("none", 0, 1, generator, SHORT)
    for before, after in zip(case.recordings, case.recordings[1:], strict=False):
        assert after.start - before.stamps[-1] > SHORT * 3600.0 * NANOSECONDS
        assert before.duration == pytest.approx(SHORT * 3600.0, abs=1.0)


@every_generator
def test_each_effect_has_what_it_needs(generator: str) -> None:
    needed: dict[str, Callable[[Case], bool]] = {
        "thermal_gradient": lambda case: all(len(r.temperature_2.stamps) > 0 for r in case.recordings),
        "supply_voltage": lambda case: all(np.ptp(r.supply_voltage.values) > 0.05 for r in case.recordings),
        "cross_axis": lambda case: all(np.ptp(r.values[:, 1]) > 5000.0 for r in case.recordings),
        "quadratic_nonlinearity": lambda case: all(np.ptp(t.acceleration) > 20000.0 for t in case.truths),
        "vibration_rectification": lambda case: all(t.acceleration.std() > 100.0 for t in case.truths),
        "post_shock_zero_shift": lambda case: all(np.ptp(t.acceleration) > 20000.0 for t in case.truths),
    }
    assert needed.keys() <= NEEDS.keys()
    for name, has in needed.items():
        assert has(single(name, generator)), name


@every_generator
def test_only_a_removed_effect_is_withheld(generator: str) -> None:
    assert single("aging", generator, group="removed").withheld == ("aging",)
    assert single("aging", generator).withheld == ()


def test_programmes_last_as_long_as_promised_and_the_held_out_one_is_inside_of_the_others() -> None:
    made = programme(np.random.default_rng(3), HOURS)
    assert all(end - start == pytest.approx(3600.0 * HOURS) for start, end in made.windows)
    case = make_case("none", 0, 1, "other", HOURS)
    seen = np.concatenate([truth.temperature for truth in case.truths[:-1]])
    held_out = case.truths[-1].temperature
    assert seen.min() < held_out.min() < -5.0
    assert 55.0 < held_out.max() < seen.max()


@every_generator
def test_the_oracle_is_near_the_floor_and_below_an_error_with_the_effect(generator: str) -> None:
    case = single("supply_voltage", generator, 0.3)
    options = training_options(generations=3)
    plain, oracle = error_of(case, train(case.training, options)), oracle_error(case, options)
    assert oracle.rms < 4.0 * oracle.best
    assert oracle.rms < 0.8 * plain.rms
    assert plain.best == pytest.approx(oracle.best, rel=0.1)


def test_names_are_right_within_their_class() -> None:
    assert right_name(("warm_up",), ("warm_up", "aging"))
    assert not right_name(("thermal_lag",), ("timing_offset",))
    assert right_class(("thermal_lag",), ("timing_offset",))
    assert not right_class(("thermal_lag",), ())
    assert right_class((), ())
    assert exact(("aging", "warm_up"), ("warm_up", "aging"))
    assert not exact(("aging",), ("aging", "warm_up"))


OUTCOME = Outcome("single", "other", ("aging",), 0, 1)
OUTCOMES = [
    replace(OUTCOME, verdict="explained", named=("aging",), before=10.0, after=2.0, oracle=1.0, best=1.0),
    replace(OUTCOME, verdict="unexplained", before=10.0, after=10.0, oracle=1.0, best=1.0),
    replace(OUTCOME, failure="it broke"),
    replace(OUTCOME, group="none", truth=(), verdict="no_effect"),
    replace(OUTCOME, group="none", truth=(), verdict="explained", named=("aging",)),
]


def test_summary_confusion_and_false_alarms() -> None:
    summary = summarise(OUTCOMES[:3])
    assert (summary.cases, summary.failures, summary.right_name, summary.unexplained) == (3, 1, 1, 1)
    assert summary.after_over_before.median == pytest.approx(0.6)
    assert confusion(OUTCOMES[:3]) == {"aging": {"aging": 1, "unexplained": 1, "failed": 1}}
    assert false_alarm_rate(OUTCOMES) == 0.5
    assert false_alarm_rate(OUTCOMES[:3]) is None


def test_tables_of_outcomes() -> None:
    made = sheets(OUTCOMES)
    assert "| single | other | 3 | 1 | 1 | 1 | 1 | 1 | 1 |" in made[0].markdown()
    assert "0.60" in made[1].markdown()
    assert [sheet.rich().row_count for sheet in made] == [2, 2, 1, 1]
    assert "50 %" in headline(OUTCOMES)
    assert json.loads(json.dumps(line_of(OUTCOMES[2])))["after"] is None


def test_a_task_goes_from_numbers_to_an_outcome(monkeypatch: pytest.MonkeyPatch) -> None:
    def diagnose(case: Case, calibration: object) -> SimpleNamespace:
        effect = SimpleNamespace(name="aging", parameters={"onset": 1.0}, p_value=0.001)
        channel = SimpleNamespace(
            name="linear_acceleration.z",
            verdict="explained",
            effects=(effect,),
            error_before=3.0,
            error_after=2.0,
            noise_floor=1.0,
        )
        return SimpleNamespace(channels=(channel,), calibration=calibration)

    monkeypatch.setattr(worker, "diagnose", diagnose)
    outcome = worker.run(worker.Task("single", EFFECTS.index("aging"), 1, "other", generations=2, hours=SHORT))
    assert (outcome.verdict, outcome.named, outcome.claimed_after) == ("explained", ("aging",), 2.0)
    assert outcome.before == outcome.after > outcome.best > 0.0
    assert outcome.oracle > 0.0


def test_the_command_line_chooses_the_cases() -> None:
    given = argument_parser().parse_args(["--groups", "single", "none", "--count", "2", "--generator", "project"])
    tasks = tasks_of(given)
    assert len(tasks) == 2 * len(EFFECTS) + 2 * len(items("none", "project"))
    assert {task.generator for task in tasks} == {"project"}
