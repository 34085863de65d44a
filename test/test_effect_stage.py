from dataclasses import dataclass, replace

import numpy as np
import pytest
from builders import LINEAR, make_stamps

from hgma_compensation.effects.applied import AppliedEffect
from hgma_compensation.effects.conditions import Conditions
from hgma_compensation.effects.effect import Effect, Need, column_of
from hgma_compensation.effects.memory import LowPass, Play
from hgma_compensation.effects.stage import EffectStage, channels_read

X, Y, Z = LINEAR
REFERENCES = (1.0, 9.81)


def drift_of(stage, at, states):
    """Return the drift (n, c) of all effects, the slow ones evaluated with each sample."""
    at = replace(at, acceleration=at.acceleration.copy())
    drift = stage.slow_drift(at, states)
    stage.add_fast(drift, at, states)
    return drift


@dataclass(frozen=True)
class Probe(Effect):
    """Answers with the acceleration of a channel, as an effect that bends with it or one that does not."""

    source: str

    name = "probe"

    @property
    def count(self):
        return 1

    def columns(self, at, state):
        return at.acceleration[:, [column_of(self.source)]]

    @classmethod
    def candidates(cls, survey):
        yield from ()


@dataclass(frozen=True)
class BendingProbe(Probe):
    per_sample = True


@dataclass(frozen=True)
class Constant(Probe):
    def columns(self, at, state):
        return np.ones((len(at), 1))


@dataclass(frozen=True)
class Needy(Constant):
    needs = (Need.SUPPLY_VOLTAGE,)


@dataclass(frozen=True)
class Count:
    """A memory that counts the samples that drive it."""

    size = 1

    def start(self):
        return np.zeros(1)

    def run(self, state, stamps, acceleration):
        return state + np.arange(1.0, len(stamps) + 1.0)[:, None]


@dataclass(frozen=True)
class Counting(Probe):
    def acceleration_memory(self):
        return Count()

    def columns(self, at, state):
        return state


@dataclass(frozen=True)
class TwoMemories(Counting):
    def memory(self):
        return LowPass((10.0, 100.0))

    @property
    def count(self):
        return 3


@dataclass(frozen=True)
class Plays(Probe):
    def memory(self):
        return Play((5.0,))

    def columns(self, at, state):
        return state


def applied(channel, kind, source=Z, gain=1.0):
    effect = kind(source)
    return AppliedEffect(channel, effect, np.full(effect.count, gain))


def conditions(acceleration, voltage=5.0):
    count = len(acceleration)
    return Conditions(
        stamps=make_stamps(np.arange(count)),
        since_power_on=np.arange(count, dtype=float),
        temperature=np.full(count, 20.0),
        rate=np.zeros(count),
        earlier=lambda _: np.full(count, 20.0),
        temperature_2=np.full(count, np.nan),
        supply_voltage=np.full(count, voltage),
        acceleration=acceleration,
    )


def stage_of(*effects):
    return EffectStage(effects, (Y, Z), REFERENCES)


ACCELERATION = np.arange(24.0).reshape(4, 6)
NO_STATES = np.empty((4, 0))
A_Y, A_Z = ACCELERATION[:, 1] - REFERENCES[0], ACCELERATION[:, 2] - REFERENCES[1]


def test_acceleration_is_taken_from_the_reference_of_calibrated_channels_and_raw_elsewhere():
    drift = drift_of(stage_of(applied(Y, Probe, Z), applied(Z, Probe, X)), conditions(ACCELERATION), NO_STATES)
    np.testing.assert_array_equal(drift, np.column_stack([A_Z, ACCELERATION[:, 0]]))


def test_those_that_do_not_bend_come_first_and_the_others_see_what_is_left_in_turn():
    effects = [applied(Z, BendingProbe, gain=0.5), applied(Z, BendingProbe, gain=0.5), applied(Z, Constant, gain=2.0)]
    drift = drift_of(stage_of(*effects), conditions(ACCELERATION), NO_STATES)[:, 1]
    left = A_Z - 2.0
    np.testing.assert_allclose(drift, 2.0 + 0.5 * left + 0.25 * left, rtol=1e-14)


def test_another_channel_is_seen_without_its_own_effects_in_whatever_order():
    effects = [applied(Z, Constant, gain=100.0), applied(Y, BendingProbe, Z), applied(Z, BendingProbe, Y)]
    for order in (effects, effects[::-1]):
        drift = drift_of(stage_of(*order), conditions(ACCELERATION), NO_STATES)
        np.testing.assert_array_equal(drift, np.column_stack([A_Z, 100.0 + A_Y]))


def test_the_given_acceleration_is_left_alone():
    given = ACCELERATION.copy()
    drift_of(stage_of(applied(Z, BendingProbe)), conditions(given), NO_STATES)
    np.testing.assert_array_equal(given, ACCELERATION)


def test_without_its_input_an_effect_is_nothing():
    stage = stage_of(applied(Z, Needy), applied(Z, Constant))
    assert stage.needs == {Need.SUPPLY_VOLTAGE}
    assert drift_of(stage, conditions(ACCELERATION), NO_STATES)[:, 1].tolist() == [2.0] * 4
    assert drift_of(stage, conditions(ACCELERATION, np.nan), NO_STATES)[:, 1].tolist() == [1.0] * 4


def test_each_sample_drives_a_memory_of_the_acceleration_once_until_it_begins_anew():
    stage = stage_of(applied(Z, Counting), applied(Y, Counting, gain=10.0))
    counts = [drift_of(stage, conditions(ACCELERATION), NO_STATES) for _ in range(2)]
    assert np.concatenate(counts)[:, 1].tolist() == list(range(1, 9))
    assert drift_of(stage, conditions(ACCELERATION[:0]), NO_STATES[:0]).shape == (0, 2)
    restored = stage_of(applied(Z, Counting), applied(Y, Counting, gain=10.0))
    restored.restore(stage.snapshot())
    assert drift_of(restored, conditions(ACCELERATION), NO_STATES).tolist() == [[10.0 * k, k] for k in range(9, 13)]
    stage.reset()
    assert drift_of(stage, conditions(ACCELERATION), NO_STATES)[0].tolist() == [10.0, 1.0]


def test_each_effect_gets_its_own_part_of_the_bank_and_both_its_memories():
    stage = stage_of(applied(Z, Plays), applied(Y, TwoMemories), applied(Z, Plays))
    assert stage.memory.size == 4
    states = np.tile(stage.memory.start(np.array([20.0])), (4, 1))
    states = stage.memory.advance(states, np.full((4, 1), 10.0), np.full((4, 1), 30.0), np.full((4, 1), 30.0))
    drift = drift_of(stage, conditions(ACCELERATION), states)
    poles = 60.0 - 10.0 * (np.exp(-1.0) + np.exp(-0.1))
    np.testing.assert_allclose(drift, np.column_stack([poles + np.arange(1.0, 5.0), np.full(4, 50.0)]), rtol=1e-14)


def test_infinite_states_survive_the_journey_through_json():
    stage = stage_of(applied(Z, Counting))
    stage.restore([["-inf"]])
    assert stage.snapshot() == [["-inf"]]
    with pytest.raises(ValueError, match="argument"):
        stage.restore([])
    with pytest.raises(ValueError, match="reshape"):
        stage.restore([[1.0, 2.0]])


def test_it_says_which_other_channels_it_reads():
    assert channels_read(Probe(X)) == (X,)
    assert stage_of(applied(Z, Probe, X), applied(Z, Probe, Y)).other_channels == (X,)
    assert stage_of().other_channels == ()
