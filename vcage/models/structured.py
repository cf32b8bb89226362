"""Typed answers: a JSON Schema with enumerations goes out, and a wrong answer goes back with the exact complaint."""

from __future__ import annotations

import difflib
import re
from collections.abc import Callable, Sequence
from typing import Annotated, Any, Literal, Protocol, TypeVar

import numpy as np
from pydantic import AfterValidator, BaseModel, ConfigDict, ValidationError, create_model
from pydantic_core import ErrorDetails

from vcage.base.errors import ModelRefused
from vcage.base.reading import Unreadable, parse_json
from vcage.base.text import one_line
from vcage.models.exchange import Answerer, Message, Question
from vcage.models.prompts import Prompt
from vcage.schema.exchange import Asked

ROUNDS = 3
"""Answers of a model before they count as a refusal."""

_FENCED = re.compile(r"```(?:json)?\s*(.*?)```", re.DOTALL)


class Answer(BaseModel):
    """Base of answer types: every field is required, and no other is allowed."""

    model_config = ConfigDict(extra="forbid")


AnswerType = TypeVar("AnswerType", bound=Answer)


def one_of(names: Sequence[str]) -> Any:
    """The type of a field that takes one of the names: an enumeration in the schema."""
    return Literal[tuple(names)]  # pyrefly: ignore[invalid-literal]  # known when the question is asked


NONE = "none"
"""Word for no name in answers: Gemini refuses enumerations with an empty text."""


def one_or_none(names: Sequence[str]) -> Any:
    """The type of a field with one of the names or :data:`NONE`, which becomes an empty text."""
    kind = one_of([NONE, *names])
    return Annotated[kind, AfterValidator(lambda name: "" if name == NONE else name)]


def narrowed(answer: type[AnswerType], **fields: Any) -> type[AnswerType]:
    """An answer type with narrower fields: only existing names."""
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
    vote: int = 1,
) -> AnswerType:
    """Ask until the answer is valid, at most :data:`ROUNDS` times.

    Args:
        role: the role that is asked.
        prompt: the filled prompt.
        answer: type of the answer; its JSON Schema is sent with the prompt.
        pictures: (caption, (H, W, 3) uint8 RGB).
        complaints: returns complaints about an answer of the right type.
        vote: see :class:`vcage.models.exchange.Question`.

    Raises:
        ModelRefused: no answer was valid; the message holds the last complaint.
        AnswerNeeded, EndpointFailed, ConfigurationError: see :class:`vcage.models.exchange.Answerer`.
    """
    turn = Message("user", prompt.text, tuple(picture for _, picture in pictures))
    captions = tuple(one_line(what) for what, _ in pictures)
    question = Question(role, (turn,), flat_schema(answer), prompt.name, captions, vote)
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
        hint=f"try another model, or --models offline; an agent answers again once ask/{question.label} is removed",
        details={"role": role, "question": question.label, "problems": list(problems), "answer": text[:2000]},
    )


class Asking(Protocol):
    """Sends a prompt and returns an answer without complaints."""

    def __call__(
        self, prompt: Prompt, answer: type[AnswerType], complaints: Callable[[AnswerType], Sequence[str]]
    ) -> AnswerType:
        """See :func:`ask`."""
        ...


def asking(who: Answerer, role: Asked) -> Asking:
    """Bind :func:`ask` to an answerer and a role."""

    def put(prompt: Prompt, answer: type[AnswerType], complaints: Callable[[AnswerType], Sequence[str]]) -> AnswerType:
        return ask(who, role, prompt, answer, complaints=complaints)

    return put


def _read(text: str, answer: type[AnswerType]) -> tuple[AnswerType | None, Sequence[str]]:
    try:
        data = parse_json(json_of(text))
    except Unreadable as error:
        return None, [f"the answer is not JSON: {error}"]
    try:
        return answer.model_validate(data), ()
    except ValidationError as error:
        return None, [f"{'.'.join(map(str, e['loc'])) or 'the answer'}: {_wrong(e)}" for e in error.errors()[:8]]


def _wrong(error: ErrorDetails) -> str:
    """Complaint about a field; of many allowed names it lists the ones with similar spelling."""
    names = re.findall(r"'([^']*)'", error.get("ctx", {}).get("expected", ""))
    if error["type"] != "literal_error":
        return error["msg"]
    if len(names) <= MAX_ENUM_NAMES:
        return f"{error['msg']}, got {error['input']!r}"
    near = difflib.get_close_matches(str(error["input"]), names, n=5, cutoff=0.4) or names[:5]
    return f"{error['input']!r} is not among the {len(names)} names; near are {', '.join(near)}"


def json_of(text: str) -> str:
    """The JSON in an answer: all of it, the contents of a fence, or the outermost braces with their contents."""
    text = text.removeprefix("\ufeff").strip()
    if text.startswith("{"):
        return text
    if fenced := _FENCED.search(text):
        return fenced[1].strip()
    start, end = text.find("{"), text.rfind("}")
    return text[start : end + 1] if 0 <= start < end else text


def _complaint(problems: Sequence[str]) -> str:
    listed = "\n".join(f"- {one_line(problem)}" for problem in problems)
    return f"That answer cannot be used:\n{listed}\nAnswer again with the whole corrected JSON object and nothing else."


_SCHEMA_KEYWORDS = ("type", "items", "required", "additionalProperties", "enum", "anyOf")
"""Keywords that all providers take; bounds of texts and numbers, which Anthropic refuses, are checked here alone."""

MAX_ENUM_NAMES = 60
"""Of an enumeration that is sent: Gemini refuses long ones. A longer one goes out as any text, and is checked here."""


def flat_schema(answer: type[BaseModel]) -> dict[str, Any]:
    """The type's JSON Schema in the subset accepted by all providers; answers are validated against the full type."""
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
        elif key in _SCHEMA_KEYWORDS:
            flat[key] = _flatten(value, definitions)
    if len(flat.get("enum", ())) > MAX_ENUM_NAMES:
        del flat["enum"]
    return flat
