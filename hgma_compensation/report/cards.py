"""Parts of a page that the reports share."""

from collections.abc import Sequence

from hgma_compensation.kept_memory import give_back
from hgma_compensation.report.markup import Html, element, inner
from hgma_compensation.report.pictures.canvas import Chart
from hgma_compensation.report.words import SPACE, number, quantity, unit

LONGEST_WORD = 24
"""Characters of a command's word that fit into a line of a phone; longer ones, paths, may be broken anywhere."""


def charts(drawn: Sequence[Chart], level: int = 4) -> Html:
    """Return charts side by side where there is room; level: of their headings."""
    give_back()  # what it took to prepare them: with a day's data tens of megabytes
    return element("div", *(chart.html(level) for chart in drawn), class_="charts")


def tile(name: str, value: float, channel: str, colour: str, *, largest: float, beside: str = "") -> Html:
    """Return a value of a channel as a tile of a list "tiles", with a bar as long as its share of the largest."""
    whole = quantity(value, channel)
    plain = f"{number(value)}{SPACE}{unit(channel)}"
    notes = [whole.removeprefix(plain).strip(f" {SPACE}()"), beside]
    width = f"width: {min(max(100.0 * value / max(largest, 1e-300), 1.0), 100.0):.1f}%"
    return element(
        "li",
        element("span", name, class_="name"),
        element("span", plain, class_="value"),
        element("span", " · ".join(note for note in notes if note), class_="beside"),
        element("span", element("span", style=width), class_=f"bar c-{colour}", aria_hidden="true"),
    )


def verdict(kind: str, headline: str, *parts: str) -> Html:
    """Return the card that says the main thing first; kind: good, calm or bad."""
    return element("section", element("p", headline, class_="headline"), *parts, class_=f"card verdict {kind}")


def badge(kind: str, text: str) -> Html:
    """Return the coloured word of a verdict; kind: good, calm or bad."""
    return element("span", text, class_=f"badge {kind}")


def command(text: str) -> Html:
    """Return a command to type; a line never ends inside of an option, which has hyphens."""
    words = (element("span", word) if len(word) <= LONGEST_WORD else inner(word) for word in text.split(" "))
    return element("code", Html(" ".join(words)), class_="command")
