"""Reads bags within 2 GB of address space, and prints a line of JSON for each: answer, s, MB at the peak."""

import json
import resource
import sys
import time
from pathlib import Path

from hgma_compensation.errors import RefusedError
from hgma_compensation.recording.bag_reader import read_recording

used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
resource.setrlimit(resource.RLIMIT_AS, (used + (2 << 30),) * 2)
for name in sys.argv[1:]:
    start = time.monotonic()
    try:
        answer = f"{len(read_recording(Path(name)).stamps)} samples"
    except RefusedError as refusal:
        answer = str(refusal)
    # Not ru_maxrss, which begins with what the process that started this one had.
    status = dict(line.split(":", 1) for line in Path("/proc/self/status").read_text().splitlines())
    peak = int(status["VmHWM"].split()[0]) // 1000
    print(json.dumps([name, answer, time.monotonic() - start, peak]), flush=True)
