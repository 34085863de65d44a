"""Memory of a process, as the kernel counts it."""

from pathlib import Path


def resident_kilobytes(pid: int) -> float:
    """Return the resident set of a process in kB (proc(5), statm counts pages; smaps_rollup counts bytes)."""
    for line in Path(f"/proc/{pid}/smaps_rollup").read_text().splitlines():
        if line.startswith("Pss_Anon:"):
            return float(line.split()[1])
    raise RuntimeError(f"process {pid} has no Pss_Anon: Linux 5.2 or newer is needed")
