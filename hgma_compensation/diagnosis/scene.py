"""What was going on at each block, and what effects make of it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.channels import CHANNELS
from hgma_compensation.diagnosis.block_sums import BlockSums
from hgma_compensation.diagnosis.blocks import Blocks
from hgma_compensation.diagnosis.carried_memory import Ends
from hgma_compensation.diagnosis.runs import Run, read_earlier, read_smoothed, since_power_on
from hgma_compensation.diagnosis.stepping import Path, walk
from hgma_compensation.effects.conditions import Conditions
from hgma_compensation.effects.effect import Effect
from hgma_compensation.effects.memory import Bank
from hgma_compensation.recording.recording import Series
from hgma_compensation.recording.spooled import Spooled
from hgma_compensation.stamps import Stamps

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
    acceleration: tuple[Spooled, ...]
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
        states = self._states(bank)
        for number, rows in enumerate(self._rows):
            if len(rows):
                for index, columns in enumerate(self._of_run(number, effects, states[number], bank)):
                    results[index].append(columns)
        return [np.concatenate(parts) for parts in results]

    @cached_property
    def _rows(self) -> tuple[NDArray[np.int64], ...]:
        """The blocks of each run."""
        return tuple(np.flatnonzero(self.blocks.run == number) for number in range(len(self.runs)))

    @cached_property
    def _mean_acceleration(self) -> tuple[Array, ...]:
        """The acceleration (n, 6) at the blocks of each run."""
        means = []
        for number in range(len(self.runs)):
            sums = self._sums(number, len(CHANNELS))
            for samples in self.acceleration[number].parts():
                sums.add(np.nan_to_num(samples))
            means.append(sums.means())
        return tuple(means)

    @cached_property
    def _at_blocks(self) -> tuple[Conditions, ...]:
        """What effects answer to at the blocks of each run: the same whatever the effects are."""
        pairs = zip(self._rows, self._mean_acceleration, strict=True)
        return tuple(self.conditions(i, self.blocks.stamps[rows], means) for i, (rows, means) in enumerate(pairs))

    def with_runs(self, runs: Sequence[Run]) -> "Scene":
        """Return the scene with other thermometers, the same acceleration at the same blocks."""
        other = replace(self, runs=tuple(runs))
        # The means take a pass over all samples, and no thermometer changes them.
        vars(other)["_mean_acceleration"] = self._mean_acceleration
        return other

    @property
    def put_in(self) -> Array:
        """Mean (n, 6) of the acceleration less the drift model at each block: what is really there."""
        means = np.empty((len(self.blocks), len(CHANNELS)))
        for rows, at in zip(self._rows, self._at_blocks, strict=True):
            means[rows] = at.acceleration
        return means

    def _of_run(self, number: int, effects: Sequence[Effect], states: Array, bank: Bank) -> list[Array]:
        """Return the columns (n, k) of each effect at the n blocks of a run; states: (n, m) of the bank."""
        places = iter(bank.columns)
        nothing = np.empty((len(states), 0))
        results: list[Array] = [nothing] * len(effects)
        for i, effect in enumerate(effects):
            if not effect.per_sample:
                own = states[:, next(places)] if effect.memory() is not None else nothing
                results[i] = effect.columns(self._at_blocks[number], own)
        for driven in (False, True):
            group = [i for i, e in enumerate(effects) if e.per_sample and e.input_driven is driven]
            if group:
                averaged = self._averaged(number, [effects[i] for i in group], driven=driven)
                for i, columns in zip(group, averaged, strict=True):
                    results[i] = columns
        return results

    def _states(self, bank: Bank) -> list[Array]:
        """Return the bank's states (n, m) at the n blocks of each run, stepped along the smoothed temperature."""
        if not bank.size:
            return [np.empty((len(rows), 0)) for rows in self._rows]
        if self.carried:
            ends = Ends(bank, self.limits)
            return [self._carried_on(bank, ends, path, run) for path, run in zip(self._paths, self.runs, strict=True)]
        states = [np.empty((0, bank.size)) for _ in self.runs]
        used = [number for number, rows in enumerate(self._rows) if len(rows)]
        if used:
            paths = [self._paths[number] for number in used]
            starts = np.stack([bank.start(path.temperature[:1]) for path in paths])
            for number, own in zip(used, walk(bank, paths, starts)[0], strict=True):
                states[number] = own
        return states

    @cached_property
    def _paths(self) -> tuple[Path, ...]:
        """What memories are told on the way to the blocks of each run."""
        pairs = zip(self.runs, self._rows, strict=True)
        return tuple(Path.along(run.smoothed, self.limits, self.blocks.stamps[rows]) for run, rows in pairs)

    @staticmethod
    def _carried_on(bank: Bank, ends: Ends, path: Path, run: Run) -> Array:
        """Return the states (n, m) where a path wants them, from where the run before ended."""
        states, end = walk(bank, [path], ends.start(run.smoothed))
        ends.keep(run.smoothed, end)
        return states[0]

    def states_about(self, effect: Effect) -> list[tuple[Array, Array]]:
        """Return the states (m,) of an effect's memory at the start and at the end of each run, carried on."""
        memory = effect.memory()
        assert memory is not None
        bank = Bank([memory])
        ends = Ends(bank, self.limits)
        states = []
        for path, run in zip(self._paths, self.runs, strict=True):
            start = ends.start(run.smoothed)[0]
            self._carried_on(bank, ends, path, run)
            states.append((start, ends.last))
        return states

    def _sums(self, number: int, width: int) -> BlockSums:
        """Return what means over the blocks of a run are made of."""
        rows = self._rows[number]
        return BlockSums(self.blocks.first[rows], self.blocks.last[rows], width)

    def _averaged(self, number: int, effects: Sequence[Effect], *, driven: bool) -> list[Array]:
        """Return the means over each block of the columns of effects at a run's samples.

        driven: whether the effects answer to the acceleration that is put in, and to no other.
        """
        column, stamps, done = CHANNELS.index(self.channel), self.runs[number].recording.stamps, 0
        memories = [effect.acceleration_memory() for effect in effects]
        states = [np.empty(0) if memory is None else memory.start() for memory in memories]
        sums = [self._sums(number, effect.count) for effect in effects]
        for samples in self.acceleration[number].parts():
            part = slice(done, done + len(samples))
            acceleration = samples.copy()
            if driven:
                acceleration[:, column] = np.where(self._moving(number, part), samples[:, column], 0.0)
            at = self.conditions(number, stamps[part], acceleration)
            for i, (effect, memory) in enumerate(zip(effects, memories, strict=True)):
                passed = np.empty((len(at), 0))
                if memory is not None:
                    passed = memory.run(states[i], at.stamps, at.acceleration[:, column])
                    states[i] = passed[-1].copy()
                sums[i].add(effect.columns(at, passed))
            done = part.stop
        return [one.means() for one in sums]

    def _moving(self, number: int, part: slice) -> NDArray[np.bool_]:
        """Return for samples of a run whether the channel is not at rest: noise and drift are no input."""
        moving = np.zeros(part.stop - part.start, dtype=bool)
        rows = self._rows[number]
        rows = rows[self.moving[rows] & (self.blocks.first[rows] < part.stop) & (self.blocks.last[rows] > part.start)]
        for row in rows:
            moving[max(self.blocks.first[row] - part.start, 0) : self.blocks.last[row] - part.start] = True
        return moving


def _held(series: Series, stamps: Stamps) -> Array:
    """Return the newest value at stamps (n,), NaN before the first."""
    if not len(series.stamps):
        return np.full(len(stamps), np.nan)
    index = np.searchsorted(series.stamps, stamps, side="right") - 1
    return np.where(index >= 0, series.values[np.maximum(index, 0)], np.nan)
