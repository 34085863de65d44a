"""The table of docs/ARCHITECTURE.md: each package, its job, and what it imports."""

import ast
from collections.abc import Iterator
from pathlib import Path

import hgma_compensation

ROOT = Path(hgma_compensation.__file__).parent


def table() -> str:
    """Return the table as Markdown, read off the sources."""
    rows = ["| package | job | imports |", "| --- | --- | --- |"]
    for package in packages():
        uses = ", ".join(f"`{name}`" for name in sorted(imported(package))) or "none"
        rows.append(f"| `{package}` | {_job(package)} | {uses} |")
    return "\n".join(rows)


def packages() -> list[str]:
    """Return the names of the packages in hgma_compensation."""
    return sorted(path.parent.name for path in ROOT.glob("*/__init__.py"))


def imported(package: str) -> set[str]:
    """Return the other packages that a package imports from."""
    known, found = set(packages()), set()
    for file in (ROOT / package).rglob("*.py"):
        for name in _modules(ast.parse(file.read_text(encoding="utf-8"))):
            parts = name.split(".")
            if parts[0] == ROOT.name and len(parts) > 1 and parts[1] in known - {package}:
                found.add(parts[1])
    return found


def _modules(tree: ast.AST) -> Iterator[str]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def _job(package: str) -> str:
    """Return the first sentence of a package's docstring."""
    text = ast.get_docstring(ast.parse((ROOT / package / "__init__.py").read_text(encoding="utf-8"))) or ""
    return " ".join(text.split("\n\n")[0].split()).rstrip(".")
