"""The part of a document that a command writes."""

import re
from pathlib import Path

from hgma_compensation.errors import RefusedError

BEGIN, END = "<!-- begin: written by make pictures -->", "<!-- end: written by make pictures -->"


def write_between_marks(document: Path, content: str) -> None:
    """Put the content between the marks of a document; raises RefusedError where these are missing."""
    text = document.read_text(encoding="utf-8")
    pattern = f"{re.escape(BEGIN)}.*?{re.escape(END)}"
    if not re.search(pattern, text, re.DOTALL):
        raise RefusedError(f"{document}: lacks the marks {BEGIN} and {END}: add them where the tables belong")
    text = re.sub(pattern, lambda _: f"{BEGIN}\n\n{content}\n\n{END}", text, count=1, flags=re.DOTALL)
    document.write_text(text, encoding="utf-8")
