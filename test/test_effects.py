"""What holds for every effect that is registered."""

from collections.abc import Iterator
from dataclasses import dataclass, fields, replace

import numpy as np
import pytest
from test_effects_examples import EPOCH, SURVEY, columns, conditions, example, row, states, wild

from hgma_compensation.effects import registry
from hgma_compensation.effects.conditions import Conditions
from hgma_compensation.effects.effect import Array, Effect, Survey
from hgma_compensation.errors import RefusedError

NAMES = list(registry.kinds())
OF_MOVING_TEMPERATURE = (
    "hysteresis",
    "rate_dependent_hysteresis",
    "stress_relaxation",
    "thermal_lag",
    "timing_offset",
)
SURVEYS = {
    "oven test": SURVEY,
    "steady": replace(SURVEY, lowest=25.0, highest=25.0, ramp=0.0),
    "short": replace(SURVEY, duration=20.0, interval=0.001),
    "coarse": replace(SURVEY, duration=3e7, interval=3600.0),
    "without noise": replace(SURVEY, noise=0.0, voltage=0.0, others=()),
    "wide and fast": replace(SURVEY, lowest=-100.0, highest=250.0, ramp=100.0, noise=1e5),
    "simulated from zero": replace(SURVEY, origin=0),
}


@pytest.mark.parametrize("name", NAMES)
def test_kind_describes_itself(name: str) -> None:
    kind = registry.kinds()[name]
    assert kind.name == name
    assert kind.title
    assert kind.identified_by
    assert "(" in (kind.__doc__ or ""), "the docstring has no source"
    assert name not in kind.confused_with
    assert set(kind.confused_with) <= set(NAMES)
    assert kind.family in ("", *NAMES)
    numeric = {field.name for field in fields(kind) if field.type in (float, "float")}  # type: ignore[arg-type]
    assert set(kind.spans) == numeric


@pytest.mark.parametrize("name", NAMES)
def test_columns_of_a_batch_are_those_of_its_rows(name: str) -> None:
    effect, at = example(name), wild()
    state = states(effect, at)
    batch = effect.columns(at, state)
    assert batch.shape == (len(at), effect.count)
    assert np.isfinite(batch).all()
    assert np.ptp(batch, axis=0).min() > 0.0, "a column never moves"
    single = np.vstack([effect.columns(row(at, index), state[index : index + 1]) for index in range(len(at))])
    assert batch.tobytes() == single.tobytes()


@pytest.mark.parametrize("name", NAMES)
def test_columns_of_no_samples_are_empty(name: str) -> None:
    effect = example(name)
    none = conditions(np.empty(0), lambda time: 20.0 + 0.0 * time)
    assert columns(effect, none).shape == (0, effect.count)


@pytest.mark.parametrize("name", NAMES)
def test_parameters_make_the_same_effect(name: str) -> None:
    effect = example(name)
    assert registry.make(name, effect.parameters()) == effect


def _wrong_values() -> Iterator[tuple[str, str, float | str]]:
    for name, kind in registry.kinds().items():
        for parameter, span in kind.spans.items():
            margin = 1e-3 * (abs(span.upper) + abs(span.lower))
            yield from ((name, parameter, value) for value in (span.lower - margin, span.upper + margin, np.nan))
        for field in fields(kind):  # type: ignore[arg-type]
            if field.name not in kind.spans:
                yield name, field.name, "linear_acceleration.w"
    for name in ("thermal_lag", "timing_offset"):
        yield from ((name, "centres", 2.5), (name, "highest", -10.0))
    yield "hysteresis", "bend", 0.5
    yield "hysteresis", "plays", 1.5
    yield "thermal_lag", "poles", 2.5
    yield "periodic_interference", "harmonics", 1.5


@pytest.mark.parametrize(("name", "parameter", "value"), list(_wrong_values()))
def test_wrong_values_are_refused_by_name(name: str, parameter: str, value: float | str) -> None:
    with pytest.raises(RefusedError, match=rf"parameters\.{parameter} is .*, must be "):
        registry.make(name, {**example(name).parameters(), parameter: value})


@pytest.mark.parametrize("survey", SURVEYS.values(), ids=SURVEYS)
@pytest.mark.parametrize("name", NAMES)
def test_candidates_stay_inside_the_spans(name: str, survey: Survey) -> None:
    at = wild(20)
    for candidate in registry.kinds()[name].candidates(survey):
        for effect in (candidate, *candidate.richer(SURVEY)):
            effect.check()
            assert columns(effect, at).shape == (20, effect.count)
        assert all(form.count > candidate.count for form in candidate.richer(SURVEY))


@pytest.mark.parametrize("name", [name for name in NAMES if name != "periodic_interference"])
def test_an_oven_test_has_candidates(name: str) -> None:
    candidates = list(registry.kinds()[name].candidates(SURVEY))
    assert candidates
    assert len(candidates) == len(set(candidates))


@pytest.mark.parametrize("name", OF_MOVING_TEMPERATURE)
def test_a_steady_temperature_leaves_nothing(name: str) -> None:
    at = conditions(np.linspace(0.0, 5000.0, 50), lambda time: 41.7 + 0.0 * time)
    assert not columns(changed(name, before=-273.15), at).any()


@pytest.mark.parametrize("name", ["vibration_rectification", "post_shock_zero_shift"])
def test_rest_leaves_nothing(name: str) -> None:
    at = conditions(np.linspace(0.0, 50.0, 500), lambda time: 20.0 + time)
    still = replace(at, acceleration=np.full((500, 6), 9.81))
    assert not columns(changed(name, floor=0.0), still).any()


def changed(name: str, **parameters: float) -> Effect:
    """Return the example of a kind with other parameters, where it has these."""
    own = example(name).parameters()
    return registry.make(name, {**own, **{key: value for key, value in parameters.items() if key in own}})


def test_an_effect_of_ones_own_is_one_class(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(registry, "_KINDS", dict(registry.kinds()))

    @registry.register
    @dataclass(frozen=True)
    class Gravity(Effect):
        name = "gravity"
        title = "pull of the moon"
        count = 1

        def columns(self, at: Conditions, state: Array) -> Array:
            return np.sin((at.stamps - EPOCH) / 8.9424e13)[:, None]

        @classmethod
        def candidates(cls, survey: Survey) -> Iterator["Gravity"]:
            yield cls()

    effect = registry.make("gravity", {})
    assert columns(effect, wild(7)).shape == (7, 1)
    with pytest.raises(ValueError, match="is there already"):
        registry.register(type("Gravity2", (Gravity,), {}))
