"""Anthropic: messages, and what it serves."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from typing import Any

from tests.model_server import schemas
from tests.model_server.answers import answer_question
from tests.model_server.service import Call, Refused, Service, picture_of_base64, require, require_only
from tests.model_server.special import Special

LIFECYCLES = {
    "claude-sonnet-5-5": ("active", None),
    "claude-opus-5": ("active", None),
    "claude-opus-4-5": ("deprecated", "2026-12-01T00:00:00Z"),
    "claude-opus-4": ("retired", "2026-05-01T00:00:00Z"),
}

PARAMETERS = frozenset(
    [
        "model",
        "max_tokens",
        "messages",
        "system",
        "stop_sequences",
        "metadata",
        "output_config",
        "thinking",
        "service_tier",
        "stream",
    ]
)

FINISH = {"STOP": "end_turn", "MAX_TOKENS": "max_tokens", "SAFETY": "refusal"}

_ERRORS = {
    400: "invalid_request_error",
    401: "authentication_error",
    402: "billing_error",
    403: "permission_error",
    404: "not_found_error",
    413: "request_too_large",
    429: "rate_limit_error",
    503: "overloaded_error",
}


class Anthropic(Service):
    """Under ``/v1``; its calls are those with an ``anthropic-version``, and all to ``messages``."""

    name = "anthropic"
    base = ""

    def check_key(self, headers: Mapping[str, str], key: str) -> None:
        # Its pages show the first; its own client sends the second.
        sent = [headers.get("x-api-key"), headers.get("Authorization", "").removeprefix("Bearer ")]
        if key not in sent:
            raise Refused(401, "invalid x-api-key" if any(sent) else "x-api-key header is required")
        require(re.fullmatch(r"\d{4}-\d\d-\d\d", headers.get("anthropic-version", "")), "anthropic-version: missing")

    def answer(self, call: Call, special: Special) -> dict[str, Any]:
        if (call.method, call.path) == ("POST", "/v1/messages"):
            return _message(call.body, special)
        if (call.method, call.path) == ("GET", "/v1/models"):
            listed = [_model(name) for name in LIFECYCLES]
            return {"data": listed, "has_more": False, "first_id": listed[0]["id"], "last_id": listed[-1]["id"]}
        one = re.fullmatch(r"/v1/models/([\w.\-]+)", call.path)
        if one is None or call.method != "GET" or one[1] not in LIFECYCLES:
            raise Refused(404, f"model: {one[1]}" if one else "Not Found")
        return _model(one[1])

    def error(self, refused: Refused) -> dict[str, Any]:
        told = {"type": _ERRORS.get(refused.status, "api_error"), "message": refused.message}
        return {"type": "error", "error": told, "request_id": "req_1"}


def _model(name: str) -> dict[str, Any]:
    lifecycle, retires = LIFECYCLES[name]
    told = {"type": "model", "id": name, "display_name": name.replace("-", " ").title()}
    return told | {"created_at": "2026-01-01T00:00:00Z", "lifecycle": lifecycle, "retires_at": retires}


def _message(body: Mapping[str, Any], special: Special) -> dict[str, Any]:
    require_only(body, PARAMETERS, "Extra inputs are not permitted")
    model = body.get("model")
    require(isinstance(model, str) and model, "model: Field required")
    if LIFECYCLES.get(str(model), ("retired", None))[0] == "retired":
        raise Refused(404, f"model: {model}")
    most = body.get("max_tokens")
    require(isinstance(most, int) and 1 <= most <= 64_000, "max_tokens: Field required, from 1 to 64000")
    require(not body.get("stream"), "the stand-in answers at once")
    require(isinstance(body.get("messages"), list) and body["messages"], "messages: at least one message is required")
    require(body["messages"][-1].get("role") == "user", "This model does not support assistant message prefill.")
    parts = list(_parts(body["messages"]))
    pictures = [_picture(part["source"]) for part in parts if part["type"] == "image"]
    config = body.get("output_config", {})
    require_only(config, ("format", "effort"), "output_config")
    form = config.get("format", {})
    if form:
        require(form.get("type") == "json_schema" and isinstance(form.get("schema"), dict), "output_config.format")
        schemas.anthropic(form["schema"])
    text = "" if special.blocked else special.text
    if text is None:
        require(form, "the stand-in answers questions with a schema alone")
        prompt = next(part["text"] for part in parts if part["type"] == "text")
        text = json.dumps(answer_question(form["schema"], prompt, pictures))
    told = {"id": "msg_1", "type": "message", "role": "assistant", "model": model, "stop_sequence": None}
    return told | {
        "content": [{"type": "text", "text": text}] if text else [],
        "stop_reason": "refusal" if special.blocked else FINISH.get(special.finish, special.finish),
        "usage": {"input_tokens": 70, "output_tokens": 7},
    }


def _parts(messages: list[dict[str, Any]]) -> Iterator[dict[str, Any]]:
    for message in messages:
        require_only(message, ("role", "content"), "messages")
        require(message.get("role") in ("user", "assistant"), "messages.role: unknown")
        content = message.get("content")
        parts = [{"type": "text", "text": content}] if isinstance(content, str) else content
        require(isinstance(parts, list) and parts, "messages.content: missing")
        for part in parts:
            require(part.get("type") in ("text", "image"), "messages.content: unknown block")
            require(part["type"] != "text" or part.get("text"), "text content blocks must be non-empty")
        yield from parts


def _picture(source: Mapping[str, Any]) -> Any:
    require_only(source, ("type", "media_type", "data"), "source")
    require(source.get("type") == "base64", "source.type: the stand-in takes base64 alone")
    return picture_of_base64(source.get("data"), source.get("media_type"))
