"""Checks a document against a JSON Schema, and names the first field that is wrong.

Interprets the part of JSON Schema that this project's own schemas use, so that the schema which is
published is the one that decides, in the node too, where no schema library is among the
dependencies. The tests compare its verdicts with the jsonschema package.
"""

import json
import pkgutil
import re
from functools import cache
from typing import Any

from hgma_compensation.errors import RefusedError

Schema = dict[str, Any]
_TYPES: dict[str, tuple[type, ...]] = {
    "object": (dict,),
    "array": (list,),
    "string": (str,),
    "number": (int, float),
    "integer": (int,),
    "boolean": (bool,),
    "null": (type(None),),
}
_ARTICLES = {"object": "an object", "array": "an array", "integer": "an integer", "null": "null"}


@cache
def load_schema(package: str, name: str) -> Schema:
    """Return a schema that is shipped as a file of a package."""
    content = pkgutil.get_data(package, name)
    assert content is not None
    schema: Schema = json.loads(content)
    return schema


def check(document: object, schema: Schema) -> None:
    """Return if the document follows the schema; raise RefusedError naming the first field that does not."""
    _check(document, schema, schema, "")


def _check(value: object, schema: Schema, root: Schema, path: str) -> None:
    if "$ref" in schema:
        _check(value, _resolve(schema["$ref"], root), root, path)
    if "oneOf" in schema:
        _check(value, _branch(value, [_deref(s, root) for s in schema["oneOf"]], path), root, path)
    _check_kind(value, schema, path)
    if isinstance(value, bool):
        return
    if isinstance(value, dict):
        _check_object(value, schema, root, path)
    elif isinstance(value, list):
        _check_array(value, schema, root, path)
    elif isinstance(value, str):
        _check_string(value, schema, path)
    elif isinstance(value, (int, float)):
        _check_number(value, schema, path)


def _refuse(path: str, problem: str) -> RefusedError:
    return RefusedError(f"{path or 'the document'} {problem}")


def _resolve(reference: str, root: Schema) -> Schema:
    target: Any = root
    for part in reference.removeprefix("#/").split("/"):
        target = target[part]
    found: Schema = target
    return found


def _deref(schema: Schema, root: Schema) -> Schema:
    return _resolve(schema["$ref"], root) if "$ref" in schema else schema


def _branch(value: object, branches: list[Schema], path: str) -> Schema:
    """Return the alternative whose constant field the value names."""
    if not isinstance(value, dict):
        raise _refuse(path, "must be an object")
    for branch in branches:
        key = _discriminator(branch)
        if value.get(key) == branch["properties"][key]["const"]:
            return branch
    key = _discriminator(branches[0])
    known = ", ".join(repr(branch["properties"][key]["const"]) for branch in branches)
    if key not in value:
        raise _refuse(path, f"lacks the field {key!r} (one of {known})")
    raise _refuse(_join(path, key), f"is {_show(value[key])}, must be one of {known}")


def _discriminator(branch: Schema) -> str:
    return next(name for name, sub in branch["properties"].items() if "const" in sub)


def _check_kind(value: object, schema: Schema, path: str) -> None:
    if "const" in schema and (value != schema["const"] or isinstance(value, bool)):
        raise _refuse(path, f"is {_show(value)}, must be {schema['const']!r}")
    if "enum" in schema and value not in schema["enum"]:
        raise _refuse(path, f"is {_show(value)}, must be one of {', '.join(map(repr, schema['enum']))}")
    if "type" in schema:
        kinds = schema["type"] if isinstance(schema["type"], list) else [schema["type"]]
        if not any(_is_kind(value, kind) for kind in kinds):
            wanted = " or ".join(_ARTICLES.get(kind, f"a {kind}") for kind in kinds)
            raise _refuse(path, f"is {_show(value)}, must be {wanted}")


def _is_kind(value: object, kind: str) -> bool:
    if isinstance(value, bool):
        return kind == "boolean"
    if kind == "integer" and isinstance(value, float):
        return value.is_integer()
    return isinstance(value, _TYPES[kind])


def _check_object(value: dict[str, Any], schema: Schema, root: Schema, path: str) -> None:
    properties = schema.get("properties", {})
    for name in schema.get("required", ()):
        if name not in value:
            raise _refuse(path, f"lacks the field {name!r}")
    if len(value) > schema.get("maxProperties", len(value)):
        raise _refuse(path, f"has {len(value)} fields, must have at most {schema['maxProperties']}")
    named = [(name, sub) for name, sub in properties.items() if name in value]
    for pattern, sub in schema.get("patternProperties", {}).items():
        named += [(name, sub) for name in value if re.search(pattern, name)]
    if schema.get("additionalProperties") is False:
        known = {name for name, _ in named}
        for name in value:
            if name not in known:
                raise _refuse(path, f"has the unknown field {_show(name)}")
    for name, sub in named:
        _check(value[name], sub, root, _join(path, name))


def _check_array(value: list[Any], schema: Schema, root: Schema, path: str) -> None:
    fewest, most = schema.get("minItems", 0), schema.get("maxItems")
    if len(value) < fewest or (most is not None and len(value) > most):
        wanted = f"{fewest}" if fewest == most else f"{fewest} to {most}" if most is not None else f"at least {fewest}"
        raise _refuse(path, f"has {len(value)} elements, must have {wanted}")
    if "items" in schema:
        for index, item in enumerate(value):
            _check(item, schema["items"], root, f"{path}[{index}]")


def _check_string(value: str, schema: Schema, path: str) -> None:
    if not schema.get("minLength", 0) <= len(value) <= schema.get("maxLength", len(value)):
        raise _refuse(
            path,
            f"has {len(value)} characters, must have {schema.get('minLength', 0)} to {schema.get('maxLength', 'any')}",
        )
    if "pattern" in schema and not re.search(schema["pattern"], value):
        raise _refuse(path, f"is {_show(value)}, must match {schema['pattern']}")


def _check_number(value: float, schema: Schema, path: str) -> None:
    limits = (
        ("minimum", value < schema.get("minimum", value), "at least"),
        ("maximum", value > schema.get("maximum", value), "at most"),
        ("exclusiveMinimum", "exclusiveMinimum" in schema and value <= schema["exclusiveMinimum"], "above"),
    )
    for name, broken, words in limits:
        if broken:
            raise _refuse(path, f"is {value!r}, must be {words} {schema[name]!r}")


def _join(path: str, name: str) -> str:
    return f"{path}.{name}" if path else name


def _show(value: object) -> str:
    text = (
        repr(value) if not isinstance(value, (dict, list)) else f"an {'object' if isinstance(value, dict) else 'array'}"
    )
    return text if len(text) <= 60 else text[:57] + "..."
