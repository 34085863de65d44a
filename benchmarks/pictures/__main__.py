"""``python -m benchmarks.pictures``: the pictures and tables of the effects' pages."""

from pathlib import Path

import click

from benchmarks.pictures import effect_picture, effect_tables
from benchmarks.pictures.scenarios import SCENARIOS, show
from hgma_compensation.effects.registry import kinds

DOCUMENTS = Path(__file__).parents[2] / "docs"


@click.command()
@click.argument("effects", nargs=-1)
@click.option("--documents", type=click.Path(path_type=Path), default=DOCUMENTS, help="Folder of the documents.")
def main(effects: tuple[str, ...], documents: Path) -> None:
    """Draw the pictures of EFFECTS (all by default), and write the tables of their pages."""
    for name in effects or tuple(SCENARIOS):
        if name not in SCENARIOS:
            raise click.BadParameter(f"{name} has no picture, must be one of {', '.join(SCENARIOS)}")
        effect_picture.draw(name, show(name), documents / "images" / "effects" / f"{name}.png")
        effect_tables.write_into(documents / "effects" / f"{name}.md", kinds()[name])
        click.echo(name)


if __name__ == "__main__":
    main()
