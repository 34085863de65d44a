"""``python -m benchmarks.pictures``: pictures and tables of the documents that are made from the code."""

from pathlib import Path

import click

from benchmarks.pictures import effect_picture, effect_tables, packages
from benchmarks.pictures.marks import write_between_marks
from benchmarks.pictures.scenarios import SCENARIOS, show
from hgma_compensation.effects.registry import kinds

DOCUMENTS = Path(__file__).parents[2] / "docs"


@click.command()
@click.argument("effects", nargs=-1)
@click.option("--documents", type=click.Path(path_type=Path), default=DOCUMENTS, help="Folder of the documents.")
def main(effects: tuple[str, ...], documents: Path) -> None:
    """Draw the pictures of EFFECTS (all by default), and write the tables of their pages and of ARCHITECTURE.md."""
    for name in effects or tuple(SCENARIOS):
        if name not in SCENARIOS:
            raise click.BadParameter(f"{name} has no picture, must be one of {', '.join(SCENARIOS)}")
        effect_picture.draw(name, show(name), documents / "images" / "effects" / f"{name}.png")
        write_between_marks(documents / "effects" / f"{name}.md", effect_tables.table(kinds()[name]))
        click.echo(name)
    write_between_marks(documents / "ARCHITECTURE.md", packages.table())


if __name__ == "__main__":
    main()
