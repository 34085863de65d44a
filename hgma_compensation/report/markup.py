"""HTML out of functions; what is not markup already is escaped, so that no name out of data can break a page."""

from collections.abc import Sequence
from html import escape

VOID = frozenset({"meta", "br", "hr", "img", "link"})


class Html(str):
    """Text that is markup already."""

    __slots__ = ()


def inner(*children: str) -> Html:
    """Return children one after the other, those that are plain text escaped."""
    return Html("".join(child if isinstance(child, Html) else escape(child) for child in children))


def element(tag: str, /, *children: str, **attributes: str) -> Html:
    """Return an element; an attribute ``class_`` is written class, underscores inside as hyphens."""
    written = "".join(f' {key.strip("_").replace("_", "-")}="{escape(value)}"' for key, value in attributes.items())
    if tag in VOID:
        return Html(f"<{tag}{written}>")
    return Html(f"<{tag}{written}>{inner(*children)}</{tag}>")


def table(
    heads: Sequence[str],
    rows: Sequence[Sequence[str]],
    numbers: Sequence[int] = (),
    caption: str = "",
    *,
    compact: bool = False,
) -> Html:
    """Return a table that scrolls by itself on a narrow screen; numbers: columns that are set flush right.

    compact: its cells are short enough to be read on a narrow screen without scrolling.
    """

    def cells(kind: str, row: Sequence[str]) -> Html:
        return element(
            "tr",
            *(
                element(kind, cell, **({"class_": "number"} if index in numbers else {}))
                for index, cell in enumerate(row)
            ),
        )

    head = element("thead", cells("th", heads))
    body = element("tbody", *(cells("td", row) for row in rows))
    title = (element("caption", caption),) if caption else ()
    classes = {"class_": "compact"} if compact else {}
    return element("div", element("table", *title, head, body, **classes), class_="scroll", tabindex="0")


def details(summary: str, *children: str, open_: bool = False) -> Html:
    """Return a part that unfolds."""
    return element("details", element("summary", summary), *children, **({"open": ""} if open_ else {}))


def bullets(items: Sequence[str], **attributes: str) -> Html:
    """Return a list."""
    return element("ul", *(element("li", item) for item in items), **attributes)


def paragraphs(items: Sequence[str]) -> Html:
    """Return a paragraph for each item that says something."""
    return inner(*(element("p", item) for item in items if item))
