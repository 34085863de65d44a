"""One slice of a fuzzing run: documents of one seed, tried one after the other, each within bounds."""

import contextlib
import faulthandler
import random
import re
import resource
import signal
import time
import warnings
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from benchmarks.soak.fuzz import oracle, trial_run
from benchmarks.soak.fuzz.mutator import Class, Mutant, Mutator, Seeds
from hgma_compensation.calibration.document import parse_calibration
from hgma_compensation.errors import LONGEST, RefusedError

LONGEST_TRIAL = 5.0
"""s for one document, its trial run included."""

LONGEST_STANDSTILL = 20.0
"""s after which the process is killed with a traceback: a hang outside of Python does not see the alarm."""

MEMORY = 2 << 30
"""Bytes of address space beyond what the process has at the beginning."""


class HungError(BaseException):
    """A document took too long; no Exception, so that no parser can swallow it."""


@dataclass
class Outcome:
    """Counts by class and by "accepted" or "refused"; findings: problem and document; slowest: s."""

    counts: Counter[tuple[str, str]] = field(default_factory=Counter)
    signatures: set[str] = field(default_factory=set)
    findings: list[tuple[str, bytes]] = field(default_factory=list)
    slowest: float = 0.0


def run(seeds: Seeds, count: int, number: int, seed: int) -> Outcome:
    """Try ``count`` documents; the same seed and number give the same documents."""
    chance = random.Random(f"{seed}/{number}")
    mutator, outcome = Mutator(seeds, chance), Outcome()
    with _bounded():
        for _ in range(count):
            mutant = mutator.next()
            started = time.monotonic()
            signature = _try(mutant, outcome, chance)
            outcome.slowest = max(outcome.slowest, time.monotonic() - started)
            if signature not in outcome.signatures:
                outcome.signatures.add(signature)
                mutator.keep(mutant.content)
    return outcome


def _try(mutant: Mutant, outcome: Outcome, chance: random.Random) -> str:
    """Try one document, count it, note what is wrong, and return what kind of answer it got."""
    signal.setitimer(signal.ITIMER_REAL, LONGEST_TRIAL)
    faulthandler.dump_traceback_later(LONGEST_STANDSTILL, exit=True)
    try:
        verdict, signature, problem = _verdict(mutant, chance)
    except BaseException as error:  # whatever is no refusal is what is looked for
        if isinstance(error, KeyboardInterrupt):
            raise
        verdict, signature = "crashed", type(error).__name__
        problem = f"{type(error).__name__}: {str(error)[:300]}"
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        faulthandler.cancel_dump_traceback_later()
    outcome.counts[mutant.kind.value, verdict] += 1
    if problem is not None:
        outcome.findings.append((problem, mutant.content))
    return signature


def _verdict(mutant: Mutant, chance: random.Random) -> tuple[str, str, str | None]:
    """Return "accepted" or "refused", the answer without its numbers, and what is wrong with it."""
    try:
        calibration = parse_calibration(mutant.content)
    except RefusedError as refusal:
        text = str(refusal)
        one_line = text.isprintable() and ": " in text and 0 < len(text) <= LONGEST + 10
        problem = None if one_line else f"a refusal that is not one line with a remedy: {text[:200]}"
        if mutant.kind is Class.HARMLESS:
            problem = f"a valid document was refused: {text[:200]}"
        return "refused", re.sub(r"'[^']*'|[0-9.e+-]+", "#", text)[:160], problem
    problem = oracle.problem_of(mutant.content)
    if problem is not None:
        return "accepted", "accepted wrongly", f"accepted, but: {problem}"
    problem = trial_run.problem_of(calibration, chance)
    kinds = sorted({applied.effect.name for applied in calibration.effects})
    modes = sorted({channel.filter.mode.value for channel in calibration.channels})
    return "accepted", f"accepted {kinds} {modes}", problem and f"accepted, but its output: {problem}"


@contextlib.contextmanager
def _bounded() -> Iterator[None]:
    """Let a document end by HungError, MemoryError, or as an error where it would only warn."""

    def hung(*_: object) -> None:
        raise HungError(f"took more than {LONGEST_TRIAL} s")

    used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    before, handler = resource.getrlimit(resource.RLIMIT_AS), signal.signal(signal.SIGALRM, hung)
    resource.setrlimit(resource.RLIMIT_AS, (used + MEMORY, before[1]))
    faulthandler.enable()
    try:
        with warnings.catch_warnings(), np.errstate(over="warn", invalid="warn", divide="warn"):
            warnings.simplefilter("error")
            yield
    finally:
        signal.signal(signal.SIGALRM, handler)
        resource.setrlimit(resource.RLIMIT_AS, before)
