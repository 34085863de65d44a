import numpy as np
import pytest
from builders import LINEAR, make_calibration
from effect_calibrations import OFFERED
from jsonschema import Draft202012Validator

from hgma_compensation.calibration.encoding import encode
from hgma_compensation.effects.applied import AppliedEffect
from hgma_compensation.kalman.settings import FilterMode
from hgma_compensation.schema_check import check, load_schema
from hgma_compensation.temperature.features import Product

EFFECTS = [AppliedEffect(LINEAR[2], effect, np.ones(effect.count)) for effect in OFFERED[LINEAR[2]]]
CALIBRATION = load_schema("hgma_compensation.calibration", "calibration.schema.json")
SCENARIO = load_schema("hgma_compensation.simulation", "scenario.schema.json")
STATE = load_schema("hgma_compensation.pipeline", "state.schema.json")


@pytest.mark.parametrize(
    "options",
    [{}, {"method": "polynomial"}, {"mode": FilterMode.SMOOTH}, {"product": Product.REFERENCE}, {"effects": EFFECTS}],
)
def test_what_is_written_is_accepted(options):
    calibration = make_calibration(**options)
    document = {**encode(calibration), "calibration_id": calibration.calibration_id}
    check(document, CALIBRATION)
    Draft202012Validator(CALIBRATION).validate(document)


@pytest.mark.parametrize("schema", [CALIBRATION, SCENARIO, STATE])
def test_published_schemas_are_valid(schema):
    Draft202012Validator.check_schema(schema)


def keywords(schema):
    """Yield every keyword of a schema, and nothing that is only the name of a property."""
    for name, value in schema.items():
        if name in ("properties", "patternProperties", "$defs"):
            yield from [name] if name == "patternProperties" else []
            for sub in value.values():
                yield from keywords(sub)
            continue
        yield name
        for sub in value if name == "oneOf" else [value] if name == "items" else []:
            yield from keywords(sub)


@pytest.mark.parametrize("schema", [CALIBRATION, SCENARIO, STATE])
def test_published_schemas_use_only_what_is_interpreted(schema):
    interpreted = {"$ref", "oneOf", "const", "enum", "type", "required", "additionalProperties", "minItems", "maxItems"}
    interpreted |= {"items", "minLength", "maxLength", "pattern", "minimum", "maximum", "exclusiveMinimum"}
    interpreted |= {"patternProperties", "maxProperties"}
    assert set(keywords(schema)) - {"$schema", "title", "description"} <= interpreted
