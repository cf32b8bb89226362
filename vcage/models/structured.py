"""Typed answers: a JSON Schema with enumerations goes out, and what breaks it goes back with the exact complaint."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Sequence
from typing import Annotated, Any, Literal, TypeVar

import numpy as np
from pydantic import AfterValidator, BaseModel, ConfigDict, ValidationError, create_model

from vcage.base.errors import ModelRefused
from vcage.models.exchange import Answerer, Message, Question
from vcage.models.prompts import Prompt
from vcage.schema.exchange import Asked

ROUNDS = 3
"""How often a model may answer before its answers count as a refusal."""

_FENCED = re.compile(r"```(?:json)?\s*(.*?)```", re.DOTALL)


class Answer(BaseModel):
    """Base of answer types: every field is required, and no other is allowed."""

    model_config = ConfigDict(extra="forbid")


AnswerType = TypeVar("AnswerType", bound=Answer)


def one_of(names: Sequence[str]) -> Any:
    """The type of a field that takes one of the names: an enumeration in the schema."""
    return Literal[tuple(names)]  # pyrefly: ignore[invalid-literal]  # known when the question is asked


NONE = "none"
"""What an answer says for no name: Gemini refuses enumerations that hold an empty text."""


def one_or_none(names: Sequence[str]) -> Any:
    """The type of a field that takes one of the names or :data:`NONE`, which becomes an empty text."""
    kind = one_of([NONE, *names])
    return Annotated[kind, AfterValidator(lambda name: "" if name == NONE else name)]


def narrowed(answer: type[AnswerType], **fields: Any) -> type[AnswerType]:
    """An answer type with fields that take less: names of what there is."""
    definitions: dict[str, Any] = {name: (kind, ...) for name, kind in fields.items()}
    return create_model(answer.__name__, __base__=answer, **definitions)


def ask(
    who: Answerer,
    role: Asked,
    prompt: Prompt,
    answer: type[AnswerType],
    *,
    pictures: Sequence[tuple[str, np.ndarray]] = (),
    complaints: Callable[[AnswerType], Sequence[str]] = lambda _: (),
) -> AnswerType:
    """Ask until the answer is valid, at most :data:`ROUNDS` times.

    Args:
        role: which is asked.
        prompt: with its placeholders filled in.
        answer: the type of the answer; its JSON Schema is sent along.
        pictures: (what it shows, (H, W, 3) uint8 RGB).
        complaints: what is wrong with an answer of the right type; empty when nothing is.

    Raises:
        ModelRefused: no answer was valid; the message holds the last complaint.
        AnswerNeeded, EndpointFailed, ConfigurationError: see :class:`vcage.models.exchange.Answerer`.
    """
    turn = Message("user", prompt.text, tuple(picture for _, picture in pictures))
    captions = tuple(what for what, _ in pictures)
    question = Question(role, (turn,), flat_schema(answer), prompt.name, captions)
    problems: Sequence[str] = ()
    text = ""
    for _ in range(ROUNDS):
        reply = who.answer(question)
        text = reply.text
        found, problems = _read(text, answer)
        if found is not None:
            problems = complaints(found)
            if not problems:
                return found
        question = question.again(reply, _complaint(problems))
    raise ModelRefused(
        f"{who.provider} gave no valid answer in {ROUNDS} rounds: {'; '.join(problems)}",
        hint="try another model, or --models offline; an agent answers anew once its folder in ask/ is removed",
        details={"role": role, "problems": list(problems), "answer": text[:2000]},
    )


def _read(text: str, answer: type[AnswerType]) -> tuple[AnswerType | None, Sequence[str]]:
    try:
        data = json.loads(json_of(text))
    except ValueError as error:
        return None, [f"the answer is not JSON: {error}"]
    try:
        return answer.model_validate(data), ()
    except ValidationError as error:
        return None, [f"{'.'.join(map(str, e['loc'])) or 'the answer'}: {e['msg']}" for e in error.errors()[:8]]


def json_of(text: str) -> str:
    """The JSON in an answer: the whole of it, what a fence encloses, or what the outermost braces enclose."""
    text = text.strip()
    if text.startswith("{"):
        return text
    if fenced := _FENCED.search(text):
        return fenced[1].strip()
    start, end = text.find("{"), text.rfind("}")
    return text[start : end + 1] if 0 <= start < end else text


def _complaint(problems: Sequence[str]) -> str:
    listed = "\n".join(f"- {problem}" for problem in problems)
    return f"That answer cannot be used:\n{listed}\nAnswer again with the whole corrected JSON object and nothing else."


def flat_schema(answer: type[BaseModel]) -> dict[str, Any]:
    """The type's JSON Schema in the subset that all providers accept: no references, no titles, no ``const``."""
    schema = answer.model_json_schema()
    return _flatten(schema, schema.get("$defs", {}))


def _flatten(node: Any, definitions: dict[str, Any]) -> Any:
    if isinstance(node, list):
        return [_flatten(item, definitions) for item in node]
    if not isinstance(node, dict):
        return node
    if "$ref" in node:
        return _flatten(definitions[node["$ref"].rpartition("/")[2]], definitions)
    flat: dict[str, Any] = {}
    for key, value in node.items():
        if key == "properties":
            flat[key] = {name: _flatten(inner, definitions) for name, inner in value.items()}
        elif key == "const":
            flat["enum"] = [value]
        elif key not in ("title", "$defs", "description", "default"):
            flat[key] = _flatten(value, definitions)
    return flat
