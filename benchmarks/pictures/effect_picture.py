"""Draws what an effect does in an oven test: over time, and over what drives it."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from benchmarks.pictures.scenarios import Array, Shown

HEATING, COOLING, SOAK, QUIET = "#c2410c", "#1667a8", "#7b8794", "0.93"
STEADY = 0.05
"""°C/min below which the oven soaks."""

Driver = Callable[[Shown], Array | None]

DRIVERS: dict[str, tuple[str, Driver]] = {
    "cross_axis": ("acceleration along x, m/s²", lambda shown: shown.acceleration[:, 0]),
    "quadratic_nonlinearity": ("acceleration along z, m/s²", lambda shown: shown.acceleration[:, 2]),
    "supply_voltage": ("supply voltage, V", lambda shown: shown.voltage),
    "thermal_gradient": (
        "second thermometer less thermistor, °C",
        lambda shown: None if shown.temperature_2 is None else shown.temperature_2 - shown.temperature,
    ),
    "rate_dependent_hysteresis": ("rate of the temperature, °C/min", lambda shown: shown.rate),
}
"""What an effect is drawn against where it is not the temperature."""


def draw(name: str, shown: Shown, path: Path) -> None:
    """Write the picture of an effect as PNG."""
    figure = Figure(figsize=(10.0, 3.8), layout="constrained")
    grid = figure.add_gridspec(2, 2, width_ratios=(1.5, 1.0), height_ratios=(1.0, 1.6))
    oven, course = figure.add_subplot(grid[0, 0]), figure.add_subplot(grid[1, 0])
    against = figure.add_subplot(grid[:, 1])
    _by_direction(oven, shown.time, shown.temperature, shown)
    oven.set_ylabel("°C")
    oven.set_title("temperature of the sensor", loc="left", fontsize="medium")
    oven.tick_params(labelbottom=False)
    _by_direction(course, shown.time, shown.drift, shown)
    course.set_title("what the effect adds to the reading", loc="left", fontsize="medium")
    course.set_xlabel("time, h")
    course.set_ylabel("m/s²")
    course.sharex(oven)
    if name == "scale_factor_temperature":
        _relative(against, shown)
    else:
        _over_driver(against, name, shown)
    for label, colour in (("heating", HEATING), ("cooling", COOLING), ("soak", SOAK)):
        against.plot([], [], "o", color=colour, markersize=4, label=label)
    against.legend(loc="best", fontsize="small", framealpha=0.8)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=90, metadata={"Software": None})


def _over_driver(axes: Axes, name: str, shown: Shown) -> None:
    text, driver = DRIVERS.get(name, ("temperature, °C", lambda it: it.temperature))
    driving = driver(shown)
    if driving is None:
        raise ValueError(f"the scenario of {name} lacks what drives it")
    _by_direction(axes, driving, shown.drift, shown)
    axes.set_xlabel(text)
    axes.set_ylabel("m/s²")
    title = "the same over what drives it" if name in DRIVERS else "the same over the temperature"
    axes.set_title(title, loc="left", fontsize="medium")


def _relative(axes: Axes, shown: Shown) -> None:
    """Draw the effect over the acceleration along its own axis, where there is any."""
    force = shown.acceleration[:, 2]
    share = np.divide(100.0 * shown.drift, force, out=np.full(len(force), np.nan), where=np.abs(force) > 50.0)
    _by_direction(axes, shown.temperature, share, shown)
    axes.set_xlabel("temperature, °C")
    axes.set_ylabel("% of the acceleration along z")
    axes.set_title("the same over the acceleration", loc="left", fontsize="medium")


def _by_direction(axes: Axes, x: Array, y: Array, shown: Shown) -> None:
    """Draw points in the colour of heating, cooling and soak."""
    steady = np.abs(shown.rate) < STEADY
    for colour, rows in (
        (SOAK, steady),
        (HEATING, ~steady & (shown.rate > 0.0)),
        (COOLING, ~steady & (shown.rate < 0.0)),
    ):
        axes.plot(x[rows], y[rows], ".", color=colour, markersize=1.5)
    axes.grid(color=QUIET)
    axes.set_axisbelow(True)
