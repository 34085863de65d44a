"""One case from its numbers to its outcome, in a process of its own."""

import os
import time
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from importlib import import_module
from multiprocessing import get_context
from typing import Any

from benchmarks.loop.cases import CHANNEL, Case, items, make_case
from benchmarks.loop.oracle import error_of, oracle_error, training_options
from benchmarks.loop.programme import HOURS
from benchmarks.loop.score import Outcome
from benchmarks.loop.sizes import FLOOR, visible
from hgma_compensation.errors import RefusedError
from hgma_compensation.training.train import train

ONE_THREAD = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMEXPR_NUM_THREADS")
"""Variables that keep linear algebra to one thread a process; a process reads them before it imports numpy."""


@dataclass(frozen=True)
class Task:
    """A case to be made and diagnosed. generations: of the genetic search, None for its default."""

    group: str
    index: int
    seed: int
    generator: str
    generations: int | None = None
    hours: float = HOURS


def diagnose(case: Case, calibration: Any) -> Any:
    """Return the project's diagnosis of a case."""
    module = import_module("hgma_compensation.diagnosis.diagnose")
    return module.diagnose(case.training, calibration, holdout=case.holdout, withheld=frozenset(case.withheld))


def run(task: Task) -> Outcome:
    """Return the outcome of a task; a refusal is one too."""
    case = make_case(task.group, task.index, task.seed, task.generator, task.hours)
    options = training_options(task.seed, task.generations)
    try:
        calibration = train(case.training, options)
        start = time.perf_counter()
        diagnosis = diagnose(case, calibration)
        seconds = time.perf_counter() - start
        before = error_of(case, calibration)
        errors = {
            "before": before.rms,
            "best": before.best,
            "after": error_of(case, diagnosis.calibration).rms,
            "oracle": oracle_error(case, options).rms,
        }
    except RefusedError as refusal:
        return _blank(task, str(refusal))
    return outcome(case, diagnosis, {**errors, "seconds": seconds})


def outcome(case: Case, diagnosis: Any, numbers: Mapping[str, Any]) -> Outcome:
    """Return the outcome of a diagnosis; numbers: the further fields of Outcome."""
    channel = next(one for one in diagnosis.channels if one.name == CHANNEL)
    return Outcome(
        group=case.group,
        generator=case.generator,
        truth=case.truth,
        index=case.index,
        seed=case.seed,
        size=size_of(case),
        verdict=str(getattr(channel.verdict, "value", channel.verdict)),
        named=tuple(effect.name for effect in channel.effects),
        parameters=tuple(dict(effect.parameters) for effect in channel.effects),
        p_values=tuple(float(effect.p_value) for effect in channel.effects),
        claimed_before=float(channel.error_before),
        claimed_after=float(channel.error_after),
        noise_floor=float(channel.noise_floor),
        **numbers,
    )


def size_of(case: Case) -> float:
    """Return the RMS on the held-out recording of what no model of temperature can carry, over FLOOR."""
    return visible(case.true_drift_of_effect, [truth.temperature for truth in case.truths]) / FLOOR


def run_all(tasks: Sequence[Task], jobs: int) -> Iterator[Outcome]:
    """Yield the outcomes as they come, each case in a fresh process; one that dies is a failure, not the end."""
    os.environ.update(dict.fromkeys(ONE_THREAD, "1"))
    with ThreadPoolExecutor(jobs) as threads:
        running: dict[Future[Outcome], Task] = {threads.submit(_apart, task): task for task in tasks}
        try:
            for future in as_completed(running):
                error = future.exception()
                yield future.result() if error is None else _blank(running[future], f"{error!r}")
        finally:
            threads.shutdown(wait=False, cancel_futures=True)


def _apart(task: Task) -> Outcome:
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as process:
        return process.submit(run, task).result()


def _blank(task: Task, failure: str) -> Outcome:
    about = items(task.group, task.generator)
    truth = about[task.index % len(about)].truth
    return Outcome(task.group, task.generator, truth, task.index, task.seed, failure=failure)
