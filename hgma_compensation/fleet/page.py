"""``summary.html`` of ``hgma fleet``."""

from __future__ import annotations

from collections.abc import Sequence

from hgma_compensation import __version__
from hgma_compensation.channels import unit_of
from hgma_compensation.fleet.charts import charts_of
from hgma_compensation.fleet.figures import BY_NAME, FIGURES, SUMMARISED
from hgma_compensation.fleet.summary import BEYOND, State, Summary, Unit
from hgma_compensation.quantities import counted, shown_unit
from hgma_compensation.report.cards import charts
from hgma_compensation.report.markup import Html, bullets, details, element, inner, paragraphs, table
from hgma_compensation.report.page import page, section
from hgma_compensation.report.words import measured, number

WORST = 15

BADGES = {
    State.ACCEPTED: "explained",
    State.CALIBRATED: "no_effect",
    State.REJECTED: "unexplained",
    State.FAILED: "unexplained",
}
"""Classes of the page's style: good, calm, bad."""


def fleet_page(summary: Summary, title: str) -> str:
    """Return the summary as one page that needs no network."""
    about = counted(len(summary.units), "sensor") + ", judged on data that none of them was fitted to."
    head = element("header", element("h1", title), element("p", about))
    return page(
        title,
        head,
        _tiles(summary),
        *_failed(summary),
        _worst(summary),
        *_outliers(summary),
        *(_channel(summary, channel) for channel in summary.channels),
        _all(summary),
        _how(summary),
    )


def _tiles(summary: Summary) -> Html:
    share = summary.accepted_share
    tiles = [
        (
            "yield",
            "–" if share is None else f"{100.0 * share:.1f} %",
            "accepted of all" if summary.limits else "no limits",
        ),
        ("accepted", str(summary.count(State.ACCEPTED)), "keep every limit"),
        ("rejected", str(summary.count(State.REJECTED)), "break a limit"),
        ("not calibrated", str(summary.count(State.FAILED)), "see the reasons below"),
        ("outliers", str(sum(bool(unit.outliers) for unit in summary.units)), "unlike the rest"),
    ]
    if not summary.limits:
        tiles[:3] = [("calibrated", str(summary.count(State.CALIBRATED)), "give --limits to judge them")]
    items = [
        element(
            "li",
            element("span", name, class_="name"),
            element("span", value, class_="value"),
            element("span", beside, class_="beside"),
        )
        for name, value, beside in tiles
    ]
    return element("ul", *items, class_="tiles")


def badge(state: State) -> Html:
    """Return the coloured word of a state."""
    return element("span", state.value, class_=f"badge {BADGES[state]}")


def _failed(summary: Summary) -> list[Html]:
    if not summary.failed:
        return []
    rows = [[unit.name, unit.status.reason] for unit in summary.failed]
    note = "Put them right and give the same command again: only what is missing is done."
    return [section("Not calibrated", element("p", note), table(("sensor", "reason and remedy"), rows), level=2)]


def _worst(summary: Summary) -> Html:
    how = (
        "How far the figure that is worst against its limit goes: 100 % is the limit."
        if summary.limits
        else "Residual standard deviation over the fleet’s median: without --limits nothing is accepted or rejected."
    )
    return section("Worst units", element("p", how), _units(summary.worst[:WORST], summary), level=2)


def _units(units: Sequence[Unit], summary: Summary) -> Html:
    """Return a table of units; a channel is named only where there are several."""
    several = len(summary.channels) > 1
    heads = ["sensor", "state", *(["of limit", "breaks"] if summary.limits else ["of median"])]
    heads += ["channel"] if several else []
    first = len(heads)
    rows: list[list[str]] = []
    for unit in units:
        for channel, figures in unit.status.channels.items():
            own = [unit.name, badge(unit.state), _share(unit.badness)]
            if summary.limits:
                own.append(", ".join(BY_NAME[one.figure].short for one in unit.broken if one.channel == channel))
            own += [channel] if several else []
            rows.append([*own, *(_quantity(figures.get(name), name, channel) for name in SUMMARISED)])
    heads += [BY_NAME[name].short for name in SUMMARISED]
    return table(heads, rows, numbers=(2, *range(first, first + len(SUMMARISED))))


def _share(badness: float) -> str:
    return f"{100.0 * badness:.0f} %" if badness < BEYOND else "not defined"


def _quantity(value: float | None, name: str, channel: str) -> str:
    figure = BY_NAME[name]
    return measured(value, figure.unit(unit_of(channel)), figure.digits(3))


def _outliers(summary: Summary) -> list[Html]:
    found = [unit for unit in summary.units if unit.outliers]
    if not found:
        return []
    several = len(summary.channels) > 1
    ranked = sorted(found, key=lambda unit: (-max(abs(one.score) for one in unit.outliers), unit.name))
    rows: list[list[str]] = []
    for unit in ranked:
        ordered = sorted(unit.outliers, key=lambda one: -abs(one.score))
        words = [
            f"{f'{one.channel} ' if several else ''}{BY_NAME[one.figure].short} "
            f"{_quantity(one.value, one.figure, one.channel)} ({number(one.score)})"
            for one in ordered
        ]
        rows.append([unit.name, badge(unit.state), ", ".join(words)])
    note = (
        "Unlike the fleet on the side where the figure is worse, whatever the limits say. In brackets the score: "
        "0.6745 · (value − median) / median deviation, beyond 3.5 (Iglewicz and Hoaglin 1993)."
    )
    heads = ("sensor", "state", "figures and their scores")
    return [section("Outliers", element("p", note), table(heads, rows[:100]), *_left_out(len(rows)), level=2)]


def _left_out(count: int) -> list[Html]:
    return [element("p", f"{count - 100} more are in summary.json.", class_="quiet")] if count > 100 else []


def _channel(summary: Summary, channel: str) -> Html:
    limits = summary.limits.of(channel)
    rows = []
    for figure in FIGURES:
        known = sorted(value for value in summary.values(channel, figure.name) if value is not None)
        if known:
            broken = summary.broken_by(channel, figure.name)
            limit = limits.get(figure.name)
            words = "" if limit is None else f"{'≥' if figure.name == 'r_squared' else '≤'} {limit:g}"
            unit = shown_unit(figure.unit(unit_of(channel)))
            middle = known[(len(known) - 1) // 2]
            cells = [number(value, figure.digits(4)) for value in (known[0], middle, known[-1])]
            rows.append([figure.title, unit, *cells, words, str(broken) if limit is not None else ""])
    heads = ("figure", "unit", "least", "median", "greatest", "limit", "broken by")
    return element(
        "article",
        element("header", element("h2", channel)),
        section("Figures", table(heads, rows, numbers=(2, 3, 4, 5, 6))),
        section("Spread", charts(charts_of(summary, channel))),
        class_="channel",
    )


def _all(summary: Summary) -> Html:
    calibrated = [unit for unit in summary.units if unit.status.calibrated]
    return section(
        "All sensors", details(counted(len(calibrated), "calibrated sensor"), _units(calibrated, summary)), level=2
    )


def _how(summary: Summary) -> Html:
    training = summary.options.training
    notes = [
        f"No sensor of the fleet has a channel that the limits for {section_} judge." for section_ in summary.unused
    ]
    filtered = training.filter.value
    lines = [
        "Every figure is measured on the recording, or the part of one, that the sensor was not fitted to: the "
        "residual is the compensated output less the still value that the calibration keeps, in means of 5 s. Noise "
        "and bias instability are read off the Allan deviation of the compensated output; where that is filtered, they "
        "are the filter’s too.",
        f"Method {training.method.value}, seed {training.seed} for every sensor, reference {training.reference}, "
        f"filter {filtered}.",
    ]
    made = f"Made by hgma_compensation {__version__}."
    return section(
        "How it was judged", inner(*(_quiet(notes))), paragraphs(lines), element("p", made, class_="quiet"), level=2
    )


def _quiet(notes: Sequence[str]) -> list[Html]:
    return [bullets(notes)] if notes else []
