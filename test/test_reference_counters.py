"""The reference lists every counter of the diagnostics as the node has it."""

from pathlib import Path

from hgma_compensation.pipeline.reasons import REMEDIES, Skip

REFERENCE = Path(__file__).parents[1] / "docs" / "REFERENCE.md"
SKIPS = [skip.value for skip in Skip]
OTHERS = [name for name in REMEDIES if name not in SKIPS]


def table(names):
    return "\n".join(["| counter | what to do |", "| --- | --- |", *(f"| `{n}` | {REMEDIES[n]} |" for n in names)])


def test_the_reference_lists_every_counter_with_its_remedy_and_no_other():
    section = REFERENCE.read_text(encoding="utf-8").partition("\n## Counters\n")[2].partition("\n## ")[0]
    tables = "\n\n".join(part for part in section.split("\n\n") if part.startswith("|")).strip()
    expected = f"{table(SKIPS)}\n\n{table(OTHERS)}"
    assert tables == expected, f"put these two tables into the section Counters of {REFERENCE.name}:\n\n{expected}\n"
