"""A figure of matplotlib as SVG inside of a page: small, with the page's font and colours."""

import io
import re
from typing import Any

import matplotlib
from matplotlib.figure import Figure

from hgma_compensation.report.markup import Html, inner

COLOURS = {
    name: f"#0102{number:02x}"
    for number, name in enumerate(
        ("ink", "grid", "heat", "cool", "soak", "fit", "rival", "before", "after", "band"), start=1
    )
}
"""Stand-ins that are replaced by the variables of the page's style, which differ in light and dark."""

FONT_SIZE = 10.0
_SETTINGS: Any = {"svg.fonttype": "none", "svg.hashsalt": "hgma", "font.size": FONT_SIZE}
_METADATA: dict[str, None] = dict.fromkeys(("Date", "Creator", "Format", "Type"))
_EDITS = (
    (r"<!--.*?-->\s*", ""),
    (r" id=\"(?!m|p)[^\"]*\"", ""),  # all but those of markers and clips, which depend on what they hold
    (r"M ([\d.-]+ [\d.-]+) \nL \1 \n", r"M\1h0"),  # a dot, of which there are thousands
    (r"font: ([\d.]+)px [^;\"]*", r"font-size: \1px"),
)


def _shortened(tag: re.Match[str]) -> str:
    """Return a tag with coordinates to a hundredth of a point; the text between tags is not touched."""
    return re.sub(r"(\d\.\d\d)\d+", r"\1", tag.group())


def svg(figure: Figure, title: str) -> Html:
    """Return a figure as an element of a page; title: what it is called for those who do not see it."""
    file = io.StringIO()
    with matplotlib.rc_context(_SETTINGS):
        figure.savefig(file, format="svg", transparent=True, metadata=_METADATA)
    text = file.getvalue()
    text = text[text.index("<svg") :]
    box = re.search(r"viewBox=\"([\d. ]*)\"", text)
    text = text[text.index(">") + 1 :]
    text = re.sub(r"<[^>]*>", _shortened, text)
    for pattern, new in _EDITS:
        text = re.sub(pattern, new, text, flags=re.DOTALL)
    for name, stand_in in COLOURS.items():
        text = text.replace(stand_in, f"var(--{name})")
    view = box.group(1) if box else ""
    return Html(f'<svg viewBox="{view}" role="img" aria-label="{inner(title)}">{text}')
