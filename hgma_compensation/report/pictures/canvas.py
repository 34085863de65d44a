"""A small chart: matplotlib draws it, the page gives it its colours."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch
from matplotlib.path import Path
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter
from numpy.typing import NDArray

from hgma_compensation.report.markup import Html, element
from hgma_compensation.report.pictures.svg import COLOURS, FONT_SIZE, svg

Array = NDArray[np.float64]

MOST_POINTS = 2000


@dataclass
class Chart:
    """A figure with its panels, the keys of its colours (colour, mark, text), and what to see in it."""

    title: str
    caption: str = ""
    panels: int = 1
    height: float = 2.8
    keys: list[tuple[str, str, str]] = field(default_factory=list)

    def __post_init__(self) -> None:
        """Prepare the panels, which share both axes."""
        with matplotlib.rc_context({"font.size": FONT_SIZE}):
            self.figure = Figure(figsize=(4.4, self.height), layout="constrained")
            shared = self.figure.subplots(self.panels, 1, sharex=True, sharey=True, squeeze=False)
        self.axes: list[Axes] = list(shared[:, 0])
        for axes in self.axes:
            _dress(axes)

    def key(self, colour: str, mark: str, text: str) -> None:
        """Say what a colour means; mark: dot, line or dash."""
        if (colour, mark, text) not in self.keys:
            self.keys.append((colour, mark, text))

    def html(self, level: int = 5) -> Html:
        """Return the chart as a figure of the page; level: of its heading."""
        keys = [
            element("li", element("span", class_=f"mark {mark} c-{colour}", aria_hidden="true"), text)
            for colour, mark, text in self.keys
        ]
        legend = element("ul", *keys, class_="keys") if keys else Html("")
        caption = element("p", self.caption) if self.caption else Html("")
        head = element("figcaption", element(f"h{level}", self.title), caption)
        return element("figure", head, legend, svg(self.figure, self.title), class_="chart")


def _dress(axes: Axes) -> None:
    ink, grid = COLOURS["ink"], COLOURS["grid"]
    axes.spines[["top", "right"]].set_visible(False)
    for spine in axes.spines.values():
        spine.set(color=grid, linewidth=0.8)
    axes.tick_params(colors=ink, labelcolor=ink, length=0, which="both")
    axes.grid(color=grid, linewidth=0.6)
    axes.set_axisbelow(True)
    axes.locator_params(axis="x", nbins=7)
    axes.ticklabel_format(style="plain", useOffset=False)


def thinned(count: int, most: int = MOST_POINTS) -> "NDArray[np.int64]":
    """Return which of so many points are drawn."""
    return np.arange(0, count, max(1, -(-count // most)), dtype=np.int64)


def cloud(axes: Axes, x: Array, y: Array, colour: str, size: float = 2.2, alpha: float = 0.75) -> None:
    """Draw points (n,) as one path, which is a third of the text of as many markers."""
    finite = np.isfinite(x) & np.isfinite(y)
    points = np.column_stack([x[finite], y[finite]])
    if not len(points):
        return
    path = Path(np.repeat(points, 2, axis=0), np.tile([Path.MOVETO, Path.LINETO], len(points)))
    path.should_simplify = False
    stroke = COLOURS[colour]
    axes.add_patch(PathPatch(path, facecolor="none", edgecolor=stroke, linewidth=size, capstyle="round", alpha=alpha))
    axes.update_datalim(points)
    axes.autoscale_view()


def line(axes: Axes, x: Array, y: Array, colour: str, style: str = "-", width: float = 1.6) -> None:
    """Draw a line (n,), broken where a value is NaN."""
    axes.plot(x, y, color=COLOURS[colour], linestyle=style, linewidth=width, solid_capstyle="round")


def level(axes: Axes, y: float = 0.0) -> None:
    """Draw a horizontal line."""
    axes.axhline(y, color=COLOURS["ink"], linewidth=0.7, alpha=0.5)


def instant(axes: Axes, x: float, colour: str = "ink") -> None:
    """Draw a vertical line."""
    axes.axvline(x, color=COLOURS[colour], linewidth=0.8, linestyle=(0, (3, 2)), alpha=0.8)


def note(axes: Axes, text: str) -> None:
    """Write into the upper left corner of a panel."""
    axes.set_title(text, loc="left", fontsize=FONT_SIZE, color=COLOURS["ink"], pad=3)


def label(axes: Axes, x: str = "", y: str = "") -> None:
    """Name the axes."""
    if x:
        axes.set_xlabel(x, color=COLOURS["ink"])
    if y:
        axes.set_ylabel(y, color=COLOURS["ink"])


def logarithmic(axes: Axes, which: Sequence[str] = ("x", "y")) -> None:
    """Make axes logarithmic, with plain numbers at the decades."""
    for name in which:
        getattr(axes, f"set_{name}scale")("log")
        axis = getattr(axes, f"{name}axis")
        low, high = getattr(axes, f"get_{name}lim")()
        few = high < 100.0 * low
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if few else (1.0,), numticks=12))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axis.set_minor_formatter(NullFormatter())
