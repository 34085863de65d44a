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
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1000
    print(json.dumps([name, answer, time.monotonic() - start, peak]), flush=True)
