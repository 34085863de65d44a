"""Fuzzes the parser of calibrations: python -m benchmarks.soak.fuzz_calibrations --count 1000000 --seed 1 --jobs 2.

Documents are made in slices, each from the seeds in test/fuzz_corpus and what it finds by itself, so that the same seed
gives the same documents with any number of jobs. Exit code 1 where anything was found; --findings keeps the documents.
"""

import argparse
import hashlib
import json
import sys
import time
from collections import Counter
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import get_context
from pathlib import Path

from benchmarks.soak.fuzz.mutator import Seeds
from benchmarks.soak.fuzz.slice import Outcome, run

CORPUS = Path(__file__).parents[2] / "test" / "fuzz_corpus" / "calibrations"
SLICE = 20_000


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the fuzzer and print a table; return 1 where a document crashed, hung, or was accepted wrongly."""
    options = _options(arguments)
    seeds = Seeds(_documents("accepted"), _documents("refused"))
    sizes = [min(SLICE, options.count - start) for start in range(0, options.count, SLICE)]
    began, total = time.monotonic(), Outcome()
    with ProcessPoolExecutor(options.jobs, get_context("spawn")) as pool:
        slices = {pool.submit(run, seeds, size, number, options.seed): number for number, size in enumerate(sizes)}
        for done in as_completed(slices):
            try:
                part = done.result()
            except BrokenProcessPool:
                part = Outcome(findings=[(f"a process died in a slice, at the latest in {slices[done]}", b"")])
            _add(total, part)
            _save(part, options.findings)
            print(_progress(total, options.count, time.monotonic() - began), flush=True)
    seconds = time.monotonic() - began
    print(_table(total, seconds))
    print(json.dumps(_figures(total, seconds)))
    return 1 if total.findings else 0


def _options(arguments: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=1_000_000, help="documents")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    parser.add_argument("--findings", type=Path, help="folder for the documents that something is wrong with")
    return parser.parse_args(arguments)


def _documents(verdict: str) -> list[bytes]:
    return [path.read_bytes() for path in sorted((CORPUS / verdict).iterdir())]


def _add(total: Outcome, part: Outcome) -> None:
    total.counts.update(part.counts)
    total.signatures |= part.signatures
    total.findings += part.findings
    total.slowest = max(total.slowest, part.slowest)


def _progress(total: Outcome, count: int, seconds: float) -> str:
    done = sum(total.counts.values())
    return f"{done} of {count}, {done / seconds:.0f}/s, {len(total.findings)} findings"


def _save(part: Outcome, folder: Path | None) -> None:
    """Keep the documents as soon as they are found: a long run may be cut off."""
    if folder is not None and part.findings:
        folder.mkdir(parents=True, exist_ok=True)
        for _, content in part.findings:
            (folder / f"{hashlib.sha256(content).hexdigest()[:16]}.json").write_bytes(content)


def _figures(total: Outcome, seconds: float) -> dict[str, float]:
    verdicts: Counter[str] = Counter()
    for (_, verdict), number in total.counts.items():
        verdicts[verdict] += number
    done = sum(verdicts.values())
    return {
        "documents": done,
        **{verdict: verdicts[verdict] for verdict in ("accepted", "refused", "crashed")},
        "findings": len(total.findings),
        "answers": len(total.signatures),
        "slowest_s": round(total.slowest, 3),
        "per_second": round(done / seconds),
    }


def _table(total: Outcome, seconds: float) -> str:
    done, by_problem = sum(total.counts.values()), Counter(ascii(problem)[:160] for problem, _ in total.findings)
    rows = ["", "| class | accepted | refused | crashed |", "| --- | ---: | ---: | ---: |"]
    for kind in sorted({kind for kind, _ in total.counts}):
        figures = " | ".join(str(total.counts[kind, verdict]) for verdict in ("accepted", "refused", "crashed"))
        rows.append(f"| {kind} | {figures} |")
    rows += ["", f"{done} documents in {seconds:.0f} s, {done / seconds:.0f} per second"]
    rows.append(f"{len(total.signatures)} different answers, the slowest document took {total.slowest:.3f} s")
    rows.append(f"{len(total.findings)} findings")
    return "\n".join(rows + [f"  {count} x {problem}" for problem, count in by_problem.most_common(40)])


if __name__ == "__main__":
    sys.exit(main())
