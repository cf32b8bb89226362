"""The subset of JSON Schema that the services accept, as published; for Gemini, as real refusals have shown."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from typing import Any

from tests.model_server.service import require

Schema = dict[str, Any]
Check = Callable[[Schema], None]

_GEMINI = frozenset(
    [
        "type",
        "format",
        "title",
        "description",
        "enum",
        "items",
        "prefixItems",
        "minItems",
        "maxItems",
        "minimum",
        "maximum",
        "anyOf",
        "oneOf",
        "properties",
        "additionalProperties",
        "required",
        "propertyOrdering",
        "$id",
        "$defs",
        "$ref",
        "$anchor",
    ]
)
_OPENAI = frozenset(
    [
        "type",
        "format",
        "title",
        "description",
        "enum",
        "const",
        "items",
        "minItems",
        "maxItems",
        "minimum",
        "maximum",
        "exclusiveMinimum",
        "exclusiveMaximum",
        "multipleOf",
        "pattern",
        "anyOf",
        "properties",
        "additionalProperties",
        "required",
        "$defs",
        "$ref",
    ]
)
_ANTHROPIC = frozenset(
    [
        "type",
        "format",
        "title",
        "description",
        "enum",
        "const",
        "items",
        "minItems",
        "anyOf",
        "allOf",
        "properties",
        "additionalProperties",
        "required",
        "default",
        "$defs",
        "$ref",
    ]
)


def nodes(schema: Any, level: int = 0) -> Iterator[tuple[Schema, int]]:
    """Every schema within a schema, and how many objects enclose it."""
    if not isinstance(schema, dict):
        return
    yield schema, level
    inside = level + ("properties" in schema)
    for key in ("properties", "$defs"):
        for inner in schema.get(key, {}).values():
            yield from nodes(inner, inside)
    for inner in (schema.get("items"), *schema.get("anyOf", []), *schema.get("oneOf", []), *schema.get("allOf", [])):
        yield from nodes(inner, level)


def gemini(schema: Schema) -> None:
    """No enumeration that is long, or holds an empty text."""
    _keywords(schema, _GEMINI)
    enums = [node["enum"] for node, _ in nodes(schema) if "enum" in node]
    require(all(all(value != "" for value in enum) for enum in enums), "enum: must not hold an empty string")
    require(all(len(enum) <= 60 for enum in enums), "The specified schema produces a constraint with too many states")
    require(sum(map(len, enums)) <= 250, "The specified schema produces a constraint with too many states")


def openai(schema: Schema) -> None:
    """The strict mode: closed objects, all fields required, and the published limits."""
    _keywords(schema, _OPENAI)
    require(schema.get("type") == "object", "schema: the root must be an object")
    _closed(schema)
    for node, level in nodes(schema):
        require(level <= 10, "schema: more than 10 levels of nesting")
        missing = set(node.get("properties", {})) - set(node.get("required", []))
        require(not missing, f"schema: 'required' must include every key in properties; missing {sorted(missing)}")
        enum = node.get("enum", [])
        require(len(enum) <= 250 or sum(len(str(v)) for v in enum) <= 15_000, "schema: an enum is too long")
    require(sum(len(n.get("properties", {})) for n, _ in nodes(schema)) <= 5000, "schema: more than 5000 properties")
    require(sum(len(n.get("enum", [])) for n, _ in nodes(schema)) <= 1000, "schema: more than 1000 enum values")
    require(len(json.dumps(schema)) <= 120_000, "schema: more than 120000 characters")


def anthropic(schema: Schema) -> None:
    """Closed objects; no bounds of numbers and texts."""
    _keywords(schema, _ANTHROPIC)
    _closed(schema)
    require(all(node.get("minItems", 0) in (0, 1) for node, _ in nodes(schema)), "minItems: only 0 and 1")


def _keywords(schema: Schema, allowed: frozenset[str]) -> None:
    for node, _ in nodes(schema):
        unknown = sorted(node.keys() - allowed)
        require(not unknown, f"schema: {', '.join(unknown)} not supported")


def _closed(schema: Schema) -> None:
    for node, _ in nodes(schema):
        closed = node.get("type") != "object" or node.get("additionalProperties") is False
        require(closed, "schema: 'additionalProperties' is required to be supplied and to be false")
