"""What the soaks' calibrations say of their training: there was none."""

from typing import Any


def provenance(method: str, seed: int) -> dict[str, Any]:
    """Return a provenance that the schema of calibrations takes."""
    return {
        "tool": "soak",
        "method": method,
        "seed": seed,
        "block": 5.0,
        "reference": "mean",
        "recordings": [{"name": "none", "start": 0, "duration": 1.0, "samples": 1}],
    }
