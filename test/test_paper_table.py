import json

import numpy as np
import pytest

from benchmarks import paper_figures, paper_table
from benchmarks.paper_ladder import ALONE, BASELINES, FILTER_TIME_CONSTANT, LADDER
from benchmarks.paper_oven import held_out_start
from benchmarks.spread import median, spread, text
from hgma_compensation.errors import RefusedError
from hgma_compensation.evaluation.noise_floor import noise_floor
from hgma_compensation.measured_data import VARIABLE
from hgma_compensation.simulation.scenario import Oven, Step

TINY = """
scenario: 1
seed: 3
oven:
  start: 25.0
  time_constant: 20.0
  program:
    - {to: 0.0, rate: 10.0, soak: 1.0}
    - {to: 50.0, rate: 10.0, soak: 1.0}
    - {to: 0.0, rate: 20.0, soak: 1.0}
    - {to: 50.0, rate: 20.0, soak: 1.0}
    - {to: 0.0, rate: 15.0, soak: 1.0}
    - {to: 50.0, rate: 15.0, soak: 1.0}
thermistor: {rate: 2.0, noise: 0.03}
accelerometer:
  rate: 2.0
  axes:
    z: {true_value: 9.8, drift_span_g: 5367.0, rate_drift: 20.0, white_noise_g_per_h: 17130.0}
"""
ARGUMENTS = ["--generations", "2", "--still-hours", "0.5"]


@pytest.fixture
def scenario(tmp_path, monkeypatch):
    monkeypatch.setenv(VARIABLE, str(tmp_path))
    path = tmp_path / "tiny.yaml"
    path.write_text(TINY)
    return path


def test_the_table_is_printed_and_written(scenario, tmp_path, capsys):
    written = tmp_path / "figures.json"
    assert paper_table.main(["--scenario", str(scenario), "--json", str(written), *ARGUMENTS]) == 0
    printed = capsys.readouterr().out
    assert "Table 3" in printed
    assert "paper, last row" in printed
    figures = json.loads(written.read_text(encoding="utf-8"))
    assert set(figures) == {"scenario", "seeds", "floor_g", "rows"}
    assert tuple(figures["rows"]) == LADDER + ALONE + BASELINES
    for name, row in figures["rows"].items():
        assert set(row["drift"]) == {"rms_error_g", "span_g", "over_floor"}
        assert ("ratio" in row) == (name not in BASELINES)
        assert ("honest" in row) == (name not in BASELINES)
    assert figures["rows"]["original"]["ratio"]["span_g"]["median"] == 1.0
    noise = figures["rows"]["original"]["honest"]["velocity_random_walk"]
    assert noise["lower_g"]["median"] < 17130.0 / 3600.0 < noise["upper_g"]["median"]
    smoothed = figures["rows"]["RBF NN + GA + KF"]["honest"]
    assert smoothed["velocity_random_walk"] is None
    assert smoothed["bandwidth_hz"]["median"] == pytest.approx(1.0 / (2.0 * np.pi * FILTER_TIME_CONSTANT))
    assert figures["floor_g"]["with_thermistor"]["median"] >= 0.9 * figures["floor_g"]["accelerometer"]["median"]


def test_the_figures_are_drawn(scenario, tmp_path, capsys):
    folder = tmp_path / "pictures"
    assert paper_figures.main([str(folder), "--scenario", str(scenario), *ARGUMENTS]) == 0
    written = sorted(folder.iterdir())
    assert [path.suffix for path in written] == [".png"] * 5
    assert sorted(capsys.readouterr().out.split()) == [str(path) for path in written]


def test_a_scenario_without_a_rate_of_its_own_to_judge_on_is_refused(scenario, capsys):
    scenario.write_text(TINY.replace("15.0", "10.0"))
    assert paper_table.main(["--scenario", str(scenario), *ARGUMENTS]) == 2
    assert "ramp rate" in capsys.readouterr().err


def test_the_held_out_cycle_begins_with_the_first_ramp_at_the_last_rate():
    oven = Oven(25.0, 60.0, (Step(-5.0, 1.0, 10.0), Step(25.0, 1.5, 5.0), Step(10.0, 1.5, 0.0)))
    assert held_out_start(oven) == pytest.approx(40.0 * 60.0)
    with pytest.raises(RefusedError):
        held_out_start(Oven(25.0, 60.0, (Step(-5.0, 1.5, 0.0), Step(25.0, 1.0, 0.0), Step(10.0, 1.5, 0.0))))


def test_the_floor_is_that_of_white_noise_and_of_the_temperatures_error_times_the_slope():
    random = np.random.default_rng(1)
    stamps = np.arange(20_000) * 500_000_000
    temperature = np.linspace(0.0, 50.0, len(stamps))
    noise = 3.0 * random.standard_normal(len(stamps))
    wrong = temperature + np.repeat(0.1 * random.standard_normal(len(stamps) // 10), 10)
    floor = noise_floor(stamps, noise, 70.0 * temperature, (temperature, wrong), 5.0)
    assert floor.accelerometer == pytest.approx(3.0 / np.sqrt(10.0), rel=0.05)
    assert floor.with_thermistor == pytest.approx(np.hypot(3.0 / np.sqrt(10.0), 7.0), rel=0.05)


def test_spread_is_of_every_number_and_counts_the_seeds_that_have_one():
    figures = spread([{"a": 1.0, "b": {"c": 2.0}, "d": None}, {"a": 3.0, "b": None, "d": None}])
    assert figures["a"] == {"median": 2.0, "least": 1.0, "greatest": 3.0}
    assert figures["b"]["c"] == {"median": 2.0, "least": 2.0, "greatest": 2.0, "seeds": 1}
    assert figures["d"] is None
    assert median(figures, "a") == 2.0
    assert median(figures, "x", "y") is None
    assert text(figures, "a") == "2 (1 to 3)"
    assert "1 seeds only" in text(figures, "b", "c")
    assert text(figures, "d") == "not defined"
