"""The page around the sections."""

from importlib import resources
from string import Template

from hgma_compensation.report.markup import Html, element, inner


def page(title: str, *sections: Html) -> str:
    """Return a whole document that needs nothing but itself."""
    template = resources.files(__package__).joinpath("page.html").read_text(encoding="utf-8")
    return Template(template).substitute(title=inner(title), content=inner(*sections))


def section(title: str, *children: str, level: int = 3) -> Html:
    """Return a card with a title; level: of its heading, one below that of what the card is a part of."""
    return element("section", element(f"h{level}", title), *children, class_="card")
