"""OpenRouter: OpenAI's chat and pictures with references, for models of many; replies say what they cost."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from tests.model_server import openai, schemas
from tests.model_server.service import (
    Call,
    Refused,
    Service,
    drawn,
    picture_of_url,
    require,
    require_bearer,
    require_only,
)
from tests.model_server.special import Special

TEXT = ("google/gemini-4-argon", "openai/gpt-6.1-sol", "anthropic/claude-sonnet-5.5")
PICTURES = ("google/gemini-nano-banana-2.1", "openai/gpt-image-2")
ALIASES = {"~google/gemini-pro-latest": TEXT[0], "~openai/gpt-sol-latest": TEXT[1]}
"""It resolves these itself, and does not list them; the reply names the model that answered."""

IMAGES = frozenset(["model", "prompt", "input_references", "aspect_ratio", "image_size", "n", "user"])
USD = 0.004


class OpenRouter(Service):
    """Under ``/api/v1``."""

    name = "openrouter"
    base = "/api/v1"

    def check_key(self, headers: Mapping[str, str], key: str) -> None:
        require_bearer(headers, key, "No auth credentials found", "User not found.")

    def answer(self, call: Call, special: Special) -> dict[str, Any]:
        shape = _SHAPES.get((call.method, call.path.removeprefix(self.base)))
        if shape is None:
            raise Refused(404, "Not Found")
        if special.blocked:
            raise Refused(403, "Your chosen model requires moderation and your input was flagged", "violence")
        return shape(call.body, special)

    def error(self, refused: Refused) -> dict[str, Any]:
        told: dict[str, Any] = {"code": refused.status, "message": refused.message}
        if refused.reason:
            told["metadata"] = {"reasons": [refused.reason], "flagged_input": "…", "provider_name": "Google"}
        return {"error": told}


def _model(body: Mapping[str, Any], models: tuple[str, ...]) -> str:
    """The model that answers."""
    asked = body.get("model")
    found = ALIASES.get(str(asked), asked)
    if found not in models:
        raise Refused(400, f"{asked} is not a valid model ID")
    return str(found)


def _chat(body: dict[str, Any], special: Special) -> dict[str, Any]:
    model = _model(body, TEXT)
    reply = openai.chat(body, special, lambda schema: _check(model, schema))
    return reply | {"model": model, "provider": "Stand-in", "usage": openai.CHAT_USAGE | {"cost": USD}}


def _check(model: str, schema: dict[str, Any]) -> None:
    """A schema is handed on, so it must keep the limits of who answers too."""
    schemas.openai(schema)
    if model.startswith("google/"):
        schemas.gemini(schema)
    if model.startswith("anthropic/"):
        schemas.anthropic(schema)


def _images(body: dict[str, Any], special: Special) -> dict[str, Any]:
    require_only(body, IMAGES, "request")
    _model(body, PICTURES)
    require(body.get("prompt"), "prompt: Required")
    references = body.get("input_references")
    require(isinstance(references, list) and references, "input_references: Required")
    for reference in references:
        require(reference.get("type") == "image_url", "input_references: unknown type")
    data = drawn(picture_of_url(references[0]["image_url"]["url"]), special)
    told = {"created": 1_780_000_000, "usage": openai.CHAT_USAGE | {"cost": 10 * USD}}
    return told | {"data": [{"b64_json": data, "media_type": special.mime}] if data else []}


def _listed(models: tuple[str, ...], made: str) -> dict[str, Any]:
    architecture = {"input_modalities": ["text", "image"], "output_modalities": [made]}
    return {
        "data": [{"id": name, "name": name, "expiration_date": None, "architecture": architecture} for name in models]
    }


_SHAPES: dict[tuple[str, str], Callable[[dict[str, Any], Special], dict[str, Any]]] = {
    ("POST", "/chat/completions"): _chat,
    ("POST", "/images"): _images,
    ("GET", "/models"): lambda _body, _special: _listed(TEXT, "text"),
    ("GET", "/images/models"): lambda _body, _special: _listed(PICTURES, "image"),
}
