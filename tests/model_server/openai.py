"""OpenAI: chat, edits of pictures, and what it serves."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from tests.model_server import schemas
from tests.model_server.answers import answer_question
from tests.model_server.service import (
    Call,
    Refused,
    Service,
    drawn,
    picture_of_bytes,
    picture_of_url,
    require,
    require_bearer,
    require_only,
)
from tests.model_server.special import Special

TEXT = ("gpt-6.1-sol", "gpt-6.1-terra", "gpt-6-luna", "gpt-5")
PICTURES = ("gpt-image-2", "gpt-image-2.6-sunburst", "gpt-image-2.6-flare", "gpt-image-1-mini")
ENDS = {"gpt-5": "2026-12-11", "gpt-image-1-mini": "2026-12-01"}

CHAT = frozenset(
    [
        "model",
        "messages",
        "response_format",
        "max_completion_tokens",
        "n",
        "seed",
        "store",
        "metadata",
        "user",
        "safety_identifier",
        "prompt_cache_key",
        "service_tier",
        "stream",
        "reasoning_effort",
        "verbosity",
    ]
)
EDIT = frozenset(
    [
        "model",
        "prompt",
        "image",
        "mask",
        "n",
        "size",
        "quality",
        "background",
        "output_format",
        "input_fidelity",
        "user",
        "stream",
    ]
)

CHAT_USAGE = {"prompt_tokens": 70, "completion_tokens": 7, "total_tokens": 77}
PICTURE_USAGE = {
    "input_tokens": 70,
    "output_tokens": 7,
    "total_tokens": 77,
    "input_tokens_details": {"image_tokens": 60, "text_tokens": 10},
}

FINISH = {"STOP": "stop", "MAX_TOKENS": "length", "SAFETY": "content_filter"}


class OpenAi(Service):
    """Under ``/v1``."""

    name = "openai"
    base = "/v1"

    def check_key(self, headers: Mapping[str, str], key: str) -> None:
        missing = "You didn't provide an API key. You need to provide it in an Authorization header using Bearer auth."
        require_bearer(headers, key, missing, "Incorrect API key provided: ***.", "invalid_api_key")

    def answer(self, call: Call, special: Special) -> dict[str, Any]:
        if (call.method, call.path) == ("POST", "/v1/chat/completions"):
            asked_of(call.body, TEXT, "This is not a chat model and thus not supported in the v1/chat/completions")
            reply = chat(call.body, special, schemas.openai)
            return reply | {"model": f"{call.body['model']}-2026-10-01", "usage": CHAT_USAGE}
        if (call.method, call.path) == ("POST", "/v1/images/edits"):
            return _edit(call.body, special)
        if (call.method, call.path) == ("GET", "/v1/models"):
            return {"object": "list", "data": [_model(name) for name in (*TEXT, *PICTURES)]}
        if (one := re.fullmatch(r"/v1/models/([\w.\-]+)", call.path)) and call.method == "GET":
            asked_of({"model": one[1]}, (*TEXT, *PICTURES), "")
            return _model(one[1])
        raise Refused(404, f"Invalid URL ({call.method} {call.path})")

    def error(self, refused: Refused) -> dict[str, Any]:
        kind = "server_error" if refused.status >= 500 else "invalid_request_error"
        if refused.reason == "moderation_blocked":
            kind = "image_generation_user_error"
        code = refused.reason or {429: "rate_limit_exceeded"}.get(refused.status)
        return {"error": {"message": refused.message, "type": kind, "param": None, "code": code}}


def _model(name: str) -> dict[str, Any]:
    told = {"id": name, "object": "model", "created": 1_780_000_000, "owned_by": "openai"}
    return told | {"shutdown_date": ENDS.get(name)}


def asked_of(body: Mapping[str, Any], models: tuple[str, ...], other: str) -> None:
    """Refuse a model that is not served, or that does not do this."""
    model = body.get("model")
    require(isinstance(model, str) and model, "you must provide a model parameter")
    if model not in (*TEXT, *PICTURES):
        raise Refused(404, f"The model `{model}` does not exist or you do not have access to it.", "model_not_found")
    if model not in models:
        raise Refused(404, other)


def chat(body: Mapping[str, Any], special: Special, check: Callable[[dict[str, Any]], None]) -> dict[str, Any]:
    """A completion, except for its source and its cost.

    Args:
        check: holds the schema against the service's limits.
    """
    require_only(body, CHAT, "Unrecognized request argument supplied")
    require(body.get("n", 1) == 1 and not body.get("stream"), "the stand-in answers once, and at once")
    require(isinstance(body.get("messages"), list) and body["messages"], "messages: missing")
    parts = list(_parts(body["messages"]))
    pictures = [picture_of_url(part["image_url"]["url"]) for part in parts if part["type"] == "image_url"]
    message: dict[str, Any] = {"role": "assistant", "content": None, "refusal": special.refusal}
    finish = "content_filter" if special.blocked else FINISH.get(special.finish, special.finish)
    if special.refusal is None and not special.blocked:
        message["content"] = special.text
        form = body.get("response_format", {"type": "text"})
        if form["type"] == "json_schema":
            require(re.fullmatch(r"[\w-]{1,64}", form["json_schema"].get("name", "")), "json_schema.name: missing")
            require(form["json_schema"].get("strict") is True, "json_schema.strict: the stand-in wants the strict mode")
            check(form["json_schema"]["schema"])
        if special.text is None:
            require(form["type"] == "json_schema", "the stand-in answers questions with a schema alone")
            prompt = next(part["text"] for part in parts if part["type"] == "text")
            message["content"] = json.dumps(answer_question(form["json_schema"]["schema"], prompt, pictures))
    choice = {"index": 0, "message": message, "finish_reason": finish, "logprobs": None}
    return {"id": "chatcmpl-1", "object": "chat.completion", "created": 1_780_000_000, "choices": [choice]}


def _parts(messages: list[dict[str, Any]]) -> Iterator[dict[str, Any]]:
    for message in messages:
        require(message.get("role") in ("system", "developer", "user", "assistant"), "messages.role: unknown")
        content = message.get("content")
        parts = [{"type": "text", "text": content}] if isinstance(content, str) else content
        require(isinstance(parts, list) and parts, "messages.content: missing")
        for part in parts:
            require(part.get("type") in ("text", "image_url") and part["type"] in part, "messages.content: unknown")
        yield from parts


def _edit(body: dict[str, Any], special: Special) -> dict[str, Any]:
    sources = body.get("image[]") or body.get("image")
    require_only({name.removesuffix("[]"): value for name, value in body.items()}, EDIT, "Unknown parameter")
    asked_of(body, PICTURES, f"The model `{body.get('model')}` does not exist.")
    require(body.get("prompt"), "Missing required parameter: 'prompt'.")
    require(isinstance(sources, list), "Missing required parameter: 'image'.")
    if special.blocked:
        raise Refused(400, "Your request was rejected by the safety system.", "moderation_blocked")
    data = drawn(picture_of_bytes(sources[0]), special)
    form = special.mime.partition("/")[2]
    told = {"created": 1_780_000_000, "output_format": form, "usage": PICTURE_USAGE}
    return told | {"data": [{"b64_json": data}] if data else []}
