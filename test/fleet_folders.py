"""Small fleets on disk, and workers that die; found by name in the processes that are spawned."""

import os
import signal
from dataclasses import replace
from pathlib import Path

from builders import make_recording

from hgma_compensation.fleet.job import run_job
from hgma_compensation.fleet.options import FleetOptions
from hgma_compensation.fleet.run import jobs_of, run_jobs
from hgma_compensation.recording.bag_writer import write_recording
from hgma_compensation.recording.recording import Series
from hgma_compensation.training.genetic import GeneticSettings
from hgma_compensation.training.train import TrainingOptions

Z = "linear_acceleration.z"
QUICK = ["--generations", "3", "--population", "8", "--centres", "3", "--delay", "10"]
OPTIONS = FleetOptions(TrainingOptions(delay=10.0, genetic=GeneticSettings(3, 8, 3)))


def small(seed, day=0, **changes):
    """Return a short recording of one axis; its noise and span depend on the seed. day: when it was made."""
    made = make_recording(seed, 400.0, 4.0, 1.0, cycles=3.0, channels=(Z,), span=40.0 + seed % 7, noise=0.2, **changes)
    later = day * 86_400_000_000_000
    thermistor = Series(made.temperature.stamps + later, made.temperature.values)
    return replace(made, stamps=made.stamps + later, temperature=thermistor)


def write_small_sensor(folder, seed):
    folder.mkdir(parents=True)
    write_recording(small(seed), folder / "train")
    write_recording(small(seed + 1000, day=1), folder / "holdout")


def write_small_fleet(source, count):
    """Write sensors s00, s01 and so on; the last one has no thermistor."""
    for number in range(count - 1):
        write_small_sensor(source / f"s{number:02d}", number)
    last = source / f"s{count - 1:02d}"
    last.mkdir(parents=True)
    write_recording(replace(small(count), temperature=Series.empty()), last / "train")
    return source


def run_fleet(source, output, options=OPTIONS):
    """Calibrate in this process."""
    return run_jobs(jobs_of(source, output, options), lambda jobs: (run_job(job) for job in jobs))


def contents(folder):
    """Return every file by its path from the folder on."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


def die_once_on_s01(job):
    """Kill the own process at the first try of one sensor."""
    mark = job.output / "died"
    if job.sensor == "s01" and not mark.exists():
        mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return run_job(job)


def die_on_s01(job):
    """Kill the own process at every try of one sensor."""
    if job.sensor == "s01":
        os.kill(os.getpid(), signal.SIGKILL)
    return run_job(job)


def finished_in(output: Path):
    """Return how many sensors have ended."""
    return len(list(output.glob("*/status.json")))
