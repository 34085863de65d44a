"""Names of effects as people write them."""

from hgma_compensation.effects.registry import kinds
from hgma_compensation.errors import RefusedError


def parse_effects(text: str | None) -> tuple[str, ...] | None:
    """Return the names of a comma-separated list, None for all; raises RefusedError for one that is no effect."""
    if text is None or text.strip() == "all":
        return None
    names = tuple(dict.fromkeys(name.strip() for name in text.split(",") if name.strip()))
    for name in names:
        if name not in kinds():
            raise RefusedError(f"effect {name[:60]!r} is unknown, must be all or some of {', '.join(kinds())}")
    if not names:
        raise RefusedError(f"no effect is named: give all or some of {', '.join(kinds())}")
    return names
