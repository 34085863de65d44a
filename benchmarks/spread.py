"""Figures of several seeds as one."""

from collections.abc import Sequence
from typing import Any

import numpy as np


def spread(figures: Sequence[Any]) -> Any:
    """Return equally nested dictionaries as one, each number replaced by its median, least and greatest.

    Where some seeds have no figure, the others' are given with their count as "seeds"; None where none has one.
    """
    have = [one for one in figures if one is not None]
    if not have:
        return None
    if isinstance(have[0], dict):
        return {key: spread([None if one is None else one.get(key) for one in figures]) for key in have[0]}
    numbers = {"median": float(np.median(have)), "least": float(min(have)), "greatest": float(max(have))}
    return numbers if len(have) == len(figures) else {**numbers, "seeds": len(have)}


def median(figure: Any, *path: str) -> float | None:
    """Return the median at a path of keys, None where there is none."""
    for key in path:
        if not figure or key not in figure:
            return None
        figure = figure[key]
    return None if figure is None else float(figure["median"])


def text(figure: Any, *path: str, form: str = ".3g") -> str:
    """Return the median, and least and greatest in brackets where the seeds differ."""
    for key in path:
        if not figure or key not in figure:
            return ""
        figure = figure[key]
    if figure is None:
        return "not defined"
    low, high = format(figure["least"], form), format(figure["greatest"], form)
    middle = format(figure["median"], form)
    counted = f", {figure['seeds']} seeds only" if "seeds" in figure else ""
    return middle if low == high and not counted else f"{middle} ({low} to {high}{counted})"
