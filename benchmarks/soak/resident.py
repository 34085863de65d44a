"""Memory and time of a process, as the kernel counts them."""

import os
from pathlib import Path


def resident_kilobytes(pid: int) -> float:
    """Return the resident set of a process in kB (proc(5), statm counts pages; smaps_rollup counts bytes)."""
    for line in Path(f"/proc/{pid}/smaps_rollup").read_text().splitlines():
        if line.startswith("Pss_Anon:"):
            return float(line.split()[1])
    raise RuntimeError(f"process {pid} has no Pss_Anon: Linux 5.2 or newer is needed")


def processor_seconds(pid: int) -> float:
    """Return the time that a process has run on a core, in s (proc(5), utime and stime of stat)."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def children_of(pid: int) -> list[int]:
    """Return the children that the first thread of a process has started."""
    return [int(child) for child in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]
