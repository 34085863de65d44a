"""JSON files from anywhere: parsed whole or refused; nothing that they hold hangs or crashes."""

import json
from typing import Any

from hgma_compensation.errors import RefusedError
from hgma_compensation.plain_values import check_plain
from hgma_compensation.regular_file import FileKind

Document = dict[str, Any]


def parse_json(content: bytes, kind: FileKind) -> Any:
    """Return the document in the bytes of a file: plain values only, no name given twice; raises RefusedError."""

    def refuse_constant(name: str) -> Any:
        raise RefusedError(f"holds {name}, which is no number: the file is damaged, {kind.renew}")

    def unique(pairs: list[tuple[str, Any]]) -> Document:
        document: Document = {}
        for name, value in pairs:
            if name in document:
                raise RefusedError(f"{name[:60]} is given twice: the file was edited, {kind.renew}")
            document[name] = value
        return document

    try:
        text = content.decode("utf-8")
        if text.count(",") > kind.most_commas:
            raise RefusedError(f"has far more elements than {kind.name}: {kind.give}")
        document = json.loads(text, object_pairs_hook=unique, parse_constant=refuse_constant)
    except RefusedError:
        raise
    except UnicodeDecodeError:
        raise RefusedError(f"is not UTF-8 text: {kind.give}") from None
    except json.JSONDecodeError as error:
        raise RefusedError(
            f"is not complete JSON (line {error.lineno}: {error.msg}): it is truncated or damaged, {kind.copy}"
        ) from None
    except (RecursionError, ValueError):
        raise RefusedError(f"is not {kind.name}: it is nested too deeply or holds an absurd number") from None
    try:
        check_plain(document)
    except RefusedError as refusal:
        raise RefusedError(f"{refusal}: the file is damaged, {kind.renew}") from None
    return document
