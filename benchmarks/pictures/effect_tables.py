"""The part of an effect's page that is written from its class."""

from hgma_compensation.effects.effect import Effect, Need, Span

NEEDS = {
    Need.TEMPERATURE_2: "a second thermometer, `/accel/temperature_2`",
    Need.SUPPLY_VOLTAGE: "the supply voltage, `/accel/supply_voltage`",
    Need.OTHER_AXIS: "another axis in `/accel/raw`",
}


def table(kind: type[Effect]) -> str:
    """Return the tables of a kind of effect as Markdown."""
    lookalikes = ", ".join(f"[{name}]({name}.md)" for name in kind.confused_with) or "none in the catalogue"
    needs = ", ".join(NEEDS[need] for need in kind.needs) or "accelerometer and thermistor"
    rows = [
        f"| recorded | {needs} |",
        f"| must vary | {kind.identified_by} |",
        f"| looks like | {lookalikes} |",
        f"| unit of its gains | that of the channel{_plain(kind.gain_unit)} |",
    ]
    if kind.family:
        rows.append(f"| reported as | `{kind.family}` |")
    text = "\n".join(["| | |", "| --- | --- |", *rows])
    if kind.spans:
        parameters = [_row(name, span) for name, span in kind.spans.items()]
        head = ["| parameter | unit | from | to | |", "| --- | --- | --- | --- | --- |"]
        text += "\n\n" + "\n".join([*head, *parameters])
    return text


def _row(name: str, span: Span) -> str:
    how = "searched by a diagnosis" if span.searched else "given by the recording or the form"
    return f"| `{name}` | {_plain(span.unit)} | {span.lower:g} | {span.upper:g} | {how} |"


def _plain(unit: str) -> str:
    return unit.replace("^2", "²")
