"""YAML as plain data: nothing is executed, and a small file stays small when it is read.

YAML's safe loader constructs no objects, but its aliases let a kilobyte stand for gigabytes ("billion laughs"), its
merge keys copy what they merge, and its numbers may have a million digits. So the tree is looked at before it is made.
"""

import yaml

from hgma_compensation.errors import RefusedError

MOST_VALUES = 200_000
"""Values that a document may have, with every alias written out."""

LONGEST_NUMBER = 60
"""Characters. Converting a number takes time with the square of its digits."""

_PREFIX = "tag:yaml.org,2002:"
_NUMBERS = {f"{_PREFIX}int", f"{_PREFIX}float"}
_SCALARS = _NUMBERS | {f"{_PREFIX}{kind}" for kind in ("str", "bool", "null", "merge")}
_COLLECTIONS = {f"{_PREFIX}seq", f"{_PREFIX}map"}


class _CountingLoader(yaml.SafeLoader):
    """The safe loader in pure Python (the one in C overflows its stack on deep nesting), which gives up in time."""

    def __init__(self, text: str) -> None:
        super().__init__(text)
        self._values = 0

    def compose_node(self, parent: yaml.Node | None, index: int) -> yaml.Node | None:
        self._values += 1
        if self._values > MOST_VALUES:
            raise RefusedError(f"has more than {MOST_VALUES} values: make it shorter")
        node: yaml.Node | None = super().compose_node(parent, index)
        return node


def load_plain(text: str) -> object:
    """Return the one document of a YAML text: maps, lists, texts, numbers, true, false, null.

    Raises RefusedError, whose text begins with what is wrong, for anything else, and where the document written out
    without aliases would have more than MOST_VALUES values.
    """
    loader: _CountingLoader | None = None
    try:
        loader = _CountingLoader(text)
        node = loader.get_single_node()
        if node is None:
            return None
        _Size().of(node)
        document: object = loader.construct_document(node)
    except (yaml.YAMLError, ValueError, OverflowError, TypeError) as error:
        raise RefusedError(f"is no YAML: {error}: correct it") from None
    except RecursionError:
        raise RefusedError("is nested too deeply: make it flat") from None
    finally:
        if loader is not None:
            loader.dispose()
    return document


class _Size:
    """Counts the values of a tree whose branches may be shared."""

    def __init__(self) -> None:
        self._known: dict[int, int | None] = {}

    def of(self, node: yaml.Node) -> int:
        """Return the number of values with every alias written out; raises RefusedError for too many or odd ones."""
        if id(node) in self._known:
            size = self._known[id(node)]
            if size is None:
                raise RefusedError(f"{_line(node)}: an alias stands for what contains it: write it out")
            return size
        self._known[id(node)] = None
        size = 1 + sum(self.of(child) for child in _children(node))
        if size > MOST_VALUES:
            raise RefusedError(f"{_line(node)}: its aliases stand for more than {MOST_VALUES} values: write them out")
        self._known[id(node)] = size
        return size


def _children(node: yaml.Node) -> list[yaml.Node]:
    """Return the nodes inside a node; raises RefusedError for a node that is no plain data."""
    if isinstance(node, yaml.ScalarNode):
        if node.tag not in _SCALARS:
            raise RefusedError(f"{_line(node)}: {node.value[:60]!r} is no number or text: put it in quotes")
        if node.tag in _NUMBERS and len(node.value) > LONGEST_NUMBER:
            raise RefusedError(f"{_line(node)}: a number has {len(node.value)} digits: shorten it")
        return []
    if node.tag not in _COLLECTIONS:
        raise RefusedError(f"{_line(node)}: {node.tag[:60]} is no plain map or list: remove the tag")
    if isinstance(node, yaml.MappingNode):
        return [part for pair in node.value for part in pair]
    return list(node.value)


def _line(node: yaml.Node) -> str:
    return f"line {node.start_mark.line + 1}"
