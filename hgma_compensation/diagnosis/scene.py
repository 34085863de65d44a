"""What was going on at each block, and what effects make of it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.channels import CHANNELS
from hgma_compensation.diagnosis.blocks import Blocks
from hgma_compensation.diagnosis.carried_memory import Ends, enough
from hgma_compensation.diagnosis.runs import Run, read_earlier, read_smoothed, since_power_on
from hgma_compensation.effects.conditions import Conditions
from hgma_compensation.effects.effect import Effect
from hgma_compensation.effects.memory import Bank
from hgma_compensation.recording.recording import Series
from hgma_compensation.stamps import Stamps, seconds_between

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Scene:
    """Blocks of a channel with what effects answer to; columns of effects come out of it.

    limits: calibrated range of the temperature, °C. acceleration: of each run, (samples, 6), less the drift model.
    moving: (n,) blocks in which real acceleration is held along the channel. carried: whether memories of the
    temperature go on from run to run, or begin in equilibrium in each.
    """

    runs: tuple[Run, ...]
    blocks: Blocks
    limits: tuple[float, float]
    channel: str
    acceleration: tuple[Array, ...]
    moving: NDArray[np.bool_]
    carried: bool = False

    def conditions(self, run: int, stamps: Stamps, acceleration: Array) -> Conditions:
        """Return what effects answer to at stamps (n,) of a run, acceleration (n, 6)."""
        one = self.runs[run]
        temperature, rate = read_smoothed(one.smoothed, stamps)
        volts = one.recording.supply_voltage
        return Conditions(
            stamps=stamps,
            since_power_on=since_power_on(one, stamps),
            temperature=np.clip(temperature, *self.limits),
            rate=rate,
            earlier=lambda seconds: np.clip(read_earlier(one, stamps, seconds), *self.limits),
            temperature_2=(
                np.full(len(stamps), np.nan) if one.second is None else read_smoothed(one.second, stamps)[0]
            ),
            supply_voltage=_held(volts, stamps),
            acceleration=acceleration,
        )

    def columns(self, effects: Sequence[Effect]) -> list[Array]:
        """Return the columns (n, k) of each effect at the blocks; all memories move in one pass."""
        results: list[list[Array]] = [[] for _ in effects]
        bank = Bank([m for m in (e.memory() for e in effects if not e.per_sample) if m is not None])
        ends = Ends(bank, self.limits) if self.carried else None
        for number in range(len(self.runs)):
            rows = np.flatnonzero(self.blocks.run == number)
            if len(rows) or ends is not None:  # a run without blocks still moves the memories
                for index, columns in enumerate(self._of_run(number, rows, effects, bank, ends)):
                    results[index].append(columns)
        return [np.concatenate(parts) for parts in results]

    def _of_run(
        self, number: int, rows: NDArray[np.int64], effects: Sequence[Effect], bank: Bank, ends: "Ends | None"
    ) -> list[Array]:
        stamps = self.blocks.stamps[rows]
        smooth_effects = [i for i, e in enumerate(effects) if not e.per_sample]
        memories = [effects[i].memory() for i in smooth_effects]
        states = self._states(number, bank, stamps, ends) if bank.size else np.empty((len(stamps), 0))
        at = self.conditions(number, stamps, self._mean_acceleration(number, rows))
        places = iter(bank.columns)
        results: list[Array] = [np.empty((len(rows), 0))] * len(effects)
        for i, memory in zip(smooth_effects, memories, strict=True):
            own = states[:, next(places)] if memory is not None else np.empty((len(rows), 0))
            results[i] = effects[i].columns(at, own)
        for i, effect in enumerate(effects):
            if effect.per_sample:
                results[i] = self._averaged(number, rows, effect)
        return results

    def _states(self, number: int, bank: Bank, stamps: Stamps, ends: "Ends | None") -> Array:
        """Return the bank's states (n, m) at stamps (n,), stepped along the smoothed temperature."""
        run = self.runs[number].smoothed
        temperature = np.clip(run.temperature, *self.limits)
        used = enough(run.stamps)
        temperature, stepped = temperature[used], run.stamps[used]
        index = np.maximum(np.searchsorted(stepped, stamps, side="right") - 1, 0)
        steps = np.diff(stepped, prepend=stepped[:1])[:, None] * 1e-9
        state = bank.start(temperature[:1])[None] if ends is None else ends.start(run)
        kept, wanted = np.empty((len(stamps), bank.size)), 0
        for k in range(len(temperature)):
            if k:
                state = bank.advance(
                    state, steps[k : k + 1], temperature[k - 1 : k, None], temperature[k : k + 1, None]
                )
            while wanted < len(index) and index[wanted] == k:
                kept[wanted] = state[0]
                wanted += 1
        if ends is not None:
            ends.keep(run, state)
        at = np.clip(read_smoothed(run, stamps)[0], *self.limits)
        age = np.maximum(seconds_between(stamps, stepped[index]), 0.0)
        return bank.advance(kept, age[:, None], temperature[index][:, None], at[:, None])

    def states_about(self, effect: Effect) -> list[tuple[Array, Array]]:
        """Return the states (m,) of an effect's memory at the start and at the end of each run, carried on."""
        memory = effect.memory()
        assert memory is not None
        bank = Bank([memory])
        ends = Ends(bank, self.limits)
        states = []
        for number, run in enumerate(self.runs):
            start = ends.start(run.smoothed)[0]
            self._states(number, bank, run.smoothed.stamps[:1], ends)
            states.append((start, ends.last))
        return states

    def _mean_acceleration(self, number: int, rows: NDArray[np.int64]) -> Array:
        return self._block_means(rows, np.nan_to_num(self.acceleration[number]))

    def _block_means(self, rows: NDArray[np.int64], samples: Array) -> Array:
        """Return the means (n, k) over blocks of one run of its samples (m, k)."""
        sums = np.vstack([np.zeros(samples.shape[1]), np.cumsum(samples, axis=0)])
        first, last = self.blocks.first[rows], self.blocks.last[rows]
        return np.asarray((sums[last] - sums[first]) / (last - first)[:, None])

    def _averaged(self, number: int, rows: NDArray[np.int64], effect: Effect) -> Array:
        """Return the mean over each block of columns that bend with the acceleration."""
        recording, samples = self.runs[number].recording, self.acceleration[number]
        if effect.input_driven:
            samples = self._only_moving(number, rows, samples)
        at = self.conditions(number, recording.stamps, samples)
        memory = effect.acceleration_memory()
        state = np.empty((len(recording.stamps), 0))
        if memory is not None:
            state = memory.run(memory.start(), recording.stamps, samples[:, CHANNELS.index(self.channel)])
        return self._block_means(rows, effect.columns(at, state))

    def _only_moving(self, number: int, rows: NDArray[np.int64], samples: Array) -> Array:
        """Return the acceleration with 0 where the channel is at rest: noise and drift are no input."""
        column = CHANNELS.index(self.channel)
        kept = np.zeros(len(samples), dtype=bool)
        for row in rows[self.moving[rows]]:
            kept[self.blocks.first[row] : self.blocks.last[row]] = True
        masked = samples.copy()
        masked[:, column] = np.where(kept, samples[:, column], 0.0)
        return masked


def _held(series: Series, stamps: Stamps) -> Array:
    """Return the newest value at stamps (n,), NaN before the first."""
    if not len(series.stamps):
        return np.full(len(stamps), np.nan)
    index = np.searchsorted(series.stamps, stamps, side="right") - 1
    return np.where(index >= 0, series.values[np.maximum(index, 0)], np.nan)
