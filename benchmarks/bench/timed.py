"""Runs a command and prints its wall time and its largest resident set as JSON: ``python timed.py COMMAND...``.

A process of its own, and a small one: the kernel gives a child the size of its parent as the first mark of its own
peak (exec_mmap), and that of the benchmark would hide the command's.
"""

import json
import os
import sys
import time


def main() -> int:
    """Run the command; exit code of the command."""
    start = time.perf_counter()
    child = os.spawnvp(os.P_NOWAIT, sys.argv[1], sys.argv[1:])
    _, status, usage = os.wait4(child, 0)
    seconds = time.perf_counter() - start
    print(json.dumps({"seconds": seconds, "peak_megabytes": usage.ru_maxrss * 1024 / 1e6}))
    return os.waitstatus_to_exitcode(status)


if __name__ == "__main__":
    sys.exit(main())
