"""Runs all the soaks one after the other, with their full counts: ``make soak``. Takes about an hour and a half."""

import argparse
import json
import subprocess
import sys
from pathlib import Path

RUNS = {
    "reloads": ("benchmarks.soak.reloads", "--reliable", "--count", "10000"),
    "faults": ("benchmarks.soak.faults", "--seconds", "3600"),
    "kills": ("benchmarks.soak.kills", "--count", "100"),
    "loops": ("benchmarks.soak.loops", "--rounds", "20"),
    "fuzz": ("benchmarks.soak.fuzz_calibrations", "--count", "1000000", "--jobs", "2"),
}
"""Module and arguments of each; the last line that one prints is its figures as JSON."""


def main() -> int:
    """Run those that are named, or all; exit code 1 where one of them has broken a bound."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"which of them: {', '.join(RUNS)}")
    parser.add_argument("--output", type=Path, help="file for all figures, JSON")
    options = parser.parse_args()
    if unknown := set(options.names) - set(RUNS):
        parser.error(f"there is no soak {', '.join(sorted(unknown))}: choose from {', '.join(RUNS)}")
    figures, failed = {}, []
    for name in options.names or RUNS:
        print(f"{name}: python -m {' '.join(RUNS[name])}", flush=True)
        done = subprocess.run([sys.executable, "-m", *RUNS[name]], stdout=subprocess.PIPE, text=True)
        lines = done.stdout.strip().splitlines()
        print(lines[-1] if lines else "no figures", flush=True)
        figures[name] = json.loads(lines[-1]) if lines and lines[-1].startswith("{") else None
        if done.returncode:
            failed.append(name)
    if options.output:
        options.output.write_text(json.dumps(figures, indent=1) + "\n", encoding="utf-8")
    print(f"failed: {', '.join(failed)}" if failed else "all bounds held")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
