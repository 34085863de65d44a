"""All effects of a calibration together: their memories, their order, the drift that they make."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from enum import Enum
from typing import Any

import numpy as np

from hgma_compensation.channels import CHANNELS, columns_of
from hgma_compensation.effects.applied import AppliedEffect
from hgma_compensation.effects.conditions import Conditions
from hgma_compensation.effects.effect import Array, Effect, Need, column_of, no_memory
from hgma_compensation.effects.memory import AccelerationMemory, Bank, TemperatureMemory


def channels_read(effect: Effect) -> tuple[str, ...]:
    """Return the channels that an effect names in its parameters: other axes whose acceleration it answers to."""
    return tuple(value for value in effect.parameters().values() if value in CHANNELS)


class EffectStage:
    """Streaming sum of effects; a batch runs through the same steps.

    The slow effects are evaluated where their inputs change (``slow_drift``), and with each sample the rest. On each
    channel the effects that do not bend with the acceleration are added up first, all of them seeing the
    acceleration less the drift model; then come those that do, in the order of the list, each seeing the acceleration
    less all before it. Other channels are seen less their drift model only, so that the order of channels is nothing.
    An acceleration is taken from the channel's reference, its value at rest.
    """

    def __init__(self, effects: Sequence[AppliedEffect], channels: Sequence[str], references: Sequence[float]) -> None:
        """Take effects on calibrated channels, and the references (c,) of these."""
        self.effects, self._columns = tuple(effects), columns_of(channels)
        self._references = np.array(references, dtype=np.float64)
        self.needs: frozenset[Need] = frozenset(need for applied in effects for need in applied.effect.needs)
        self.delays = frozenset(applied.effect.history for applied in effects if applied.effect.history > 0.0)
        self.history = max(self.delays, default=0.0)
        parts = self._parts = [_Part(applied) for applied in effects]
        with_memory = [(part, part.memory) for part in parts if part.memory is not None]
        bank = Bank([memory for _, memory in with_memory])
        for number, (part, _) in enumerate(with_memory):
            part.places = bank.columns[number]
        self.memory: TemperatureMemory | None = bank if bank.size else None
        self._driven = [part for part in parts if part.acceleration_memory is not None]
        self._slow, self._additive, self._bent = (
            [[part for part in parts if part.on == (name, kind)] for name in channels] for kind in _Kind
        )
        fast = [part for part in parts if part.on[1] is not _Kind.SLOW]
        self.has_slow, self.has_fast = len(fast) < len(parts), bool(fast)
        self.fast_need_memory = any(len(part.places) for part in fast)
        self.reset()

    @property
    def other_channels(self) -> tuple[str, ...]:
        """The channels that the effects read beside the calibrated ones."""
        named = {channel for applied in self.effects for channel in channels_read(applied.effect)}
        calibrated = {CHANNELS[column] for column in self._columns}
        return tuple(channel for channel in CHANNELS if channel in named - calibrated)

    def reset(self) -> None:
        """Let the memories of the acceleration begin anew."""
        for part in self._driven:
            part.reset()

    def slow_drift(self, at: Conditions, states: Array) -> Array:
        """Return the drift (n, c) that the slow effects make; what ``at`` says of the acceleration is not read.

        states: (n, m) of ``memory``.
        """
        drift = np.zeros((len(at), len(self._columns)))
        for number, parts in enumerate(self._slow):
            for part in parts:
                drift[:, number] += part.drift(at, states)
        return drift

    def add_fast(self, drift: Array, at: Conditions, states: Array) -> None:
        """Add to the drift (n, c) of the slow effects what the others make; moves their memories on by n samples.

        at.acceleration: (n, 6), less the drift model in calibrated channels; it is used up. states: (n, m) of
        ``memory``, (n, 0) where ``fast_need_memory`` is not set.
        """
        acceleration = at.acceleration
        acceleration[:, self._columns] -= self._references
        for number, column in enumerate(self._columns):
            for part in self._additive[number]:
                drift[:, number] += part.drift(at, states)
            if not self._bent[number]:
                continue
            before = acceleration[:, column].copy()
            acceleration[:, column] -= drift[:, number]
            for part in self._bent[number]:
                bent = part.drift(at, states)
                drift[:, number] += bent
                acceleration[:, column] -= bent
            acceleration[:, column] = before

    def _from_rest(self, at: Conditions) -> Conditions:
        """Return the conditions with the acceleration taken from the references."""
        acceleration = at.acceleration.copy(order="K")
        acceleration[:, self._columns] -= self._references
        return replace(at, acceleration=acceleration)

    def columns(self, at: Conditions, states: Array) -> list[Array]:
        """Return the columns (n, k) of each effect, in the order of the list: what gains are fitted to.

        at.acceleration: (n, 6), less the drift model in calibrated channels; the memories of the acceleration move on.
        states: (n, m) of ``memory``.
        """
        at = self._from_rest(at)
        return [part.columns(at, states) for part in self._parts]

    def shares_memories(self, before: "EffectStage") -> bool:
        """Return whether ``succeed`` finds anything to take over."""
        return any(True for _ in self._shared(before))

    def succeed(self, before: "EffectStage", raised: Array) -> None:
        """Take over the memories of the acceleration of all effects that another stage has too, equal and as often.

        raised: (6,) by how much higher this stage sees the acceleration in each of CHANNELS.
        """
        for part, earlier in self._shared(before):
            part.take_over(earlier, float(raised[column_of(part.applied.channel)]))

    def _shared(self, before: "EffectStage") -> Iterator[tuple["_Part", "_Part"]]:
        """Yield each part with a memory of the acceleration, and the one of the stage before that is its equal."""
        left = list(before._driven)
        for part in self._driven:
            equal = next((e for e in left if part.applied.is_same(e.applied)), None)
            if equal is not None:
                left.remove(equal)
                yield part, equal

    def snapshot(self) -> list[Any]:
        """Return the states of the memories of the acceleration as plain JSON."""
        return [_plain(part.state) for part in self._driven]

    def restore(self, snapshot: Sequence[Any]) -> None:
        """Go on from a snapshot of a stage with the same effects; raises ValueError where it does not fit."""
        for part, state in zip(self._driven, snapshot, strict=True):
            part.state = np.array([float(value) for value in state]).reshape(part.state.shape)


class _Kind(Enum):
    """When an effect is evaluated: where slow inputs change, or with each sample; before or after those that bend."""

    SLOW = "slow"
    ADDITIVE = "additive"
    BENT = "bent"

    @classmethod
    def of(cls, effect: Effect) -> "_Kind":
        if effect.slow:
            return cls.SLOW
        return cls.BENT if effect.per_sample else cls.ADDITIVE


class _Part:
    """One effect with its places in the bank, and the state of its memory of the acceleration."""

    def __init__(self, applied: AppliedEffect) -> None:
        effect = applied.effect
        self.memory = effect.memory()
        self.acceleration_memory: AccelerationMemory | None = effect.acceleration_memory()
        self.places = np.empty(0, dtype=np.int64)
        self.on = (applied.channel, _Kind.of(effect))
        self.applied, self._column = applied, column_of(applied.channel)
        self.state = np.empty(0)

    def reset(self) -> None:
        if self.acceleration_memory is not None:
            self.state = self.acceleration_memory.start()

    def take_over(self, earlier: "_Part", raised: float) -> None:
        assert self.acceleration_memory is not None
        self.state = self.acceleration_memory.raised(earlier.state, raised)

    def drift(self, at: Conditions, states: Array) -> Array:
        drift = self.applied.drift(at, self._states(at, states))
        for need, given in ((Need.TEMPERATURE_2, at.temperature_2), (Need.SUPPLY_VOLTAGE, at.supply_voltage)):
            if need in self.applied.effect.needs:
                # Nothing is known of an input that has not come: better no compensation of it than no output.
                drift = np.where(np.isnan(given), 0.0, drift)
        return drift

    def columns(self, at: Conditions, states: Array) -> Array:
        return np.nan_to_num(self.applied.effect.columns(at, self._states(at, states)), nan=0.0)

    def _states(self, at: Conditions, states: Array) -> Array:
        known = states[:, self.places] if len(self.places) else no_memory(len(at))
        if self.acceleration_memory is None:
            return known
        run = np.empty((0, self.acceleration_memory.size))
        if len(at):
            run = self.acceleration_memory.run(self.state, at.stamps, at.acceleration[:, self._column])
            self.state = run[-1].copy()
        return run if not len(self.places) else np.concatenate([known, run], axis=1)


def _plain(state: Array) -> list[float | str]:
    """Return a state (m,) for JSON, which knows no infinity."""
    return [value if np.isfinite(value) else str(value) for value in state.tolist()]
