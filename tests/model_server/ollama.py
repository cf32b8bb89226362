"""Ollama: OpenAI's chat without a key, and what its own interface says of models."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from tests.model_server import openai
from tests.model_server.service import Call, Refused, Service, require
from tests.model_server.special import Special

CAPABILITIES = {
    "nomic-embed-text:latest": ["embedding"],
    "qwen3-vl:8b": ["completion", "vision", "tools"],
    "llama3.2:3b": ["completion", "tools"],
}
"""Models that the server has, the newest first, and the abilities of each."""


class Ollama(Service):
    """Under ``/ollama``, as behind a proxy; it takes no key.

    Attributes:
        capabilities: by model; a test may have others.
        context: tokens that its models are loaded with.
    """

    name = "ollama"
    base = "/ollama"

    def __init__(self) -> None:
        self.capabilities = dict(CAPABILITIES)
        self.context = 32_768

    def check_key(self, headers: Mapping[str, str], key: str) -> None:
        require("Authorization" not in headers, "the stand-in wants no key sent to a server that needs none")

    def answer(self, call: Call, special: Special) -> dict[str, Any]:
        asked = (call.method, call.path.removeprefix(self.base))
        if asked == ("POST", "/v1/chat/completions"):
            return self._chat(call.body, special)
        if asked == ("GET", "/v1/models"):
            listed = [{"id": name, "object": "model", "owned_by": "library"} for name in self.capabilities]
            return {"object": "list", "data": listed or None}
        if asked == ("POST", "/api/show"):
            return {"capabilities": self.capabilities[self._model(call.body)], "details": {"format": "gguf"}}
        if asked == ("GET", "/api/ps"):
            return {"models": [{"name": name, "context_length": self.context} for name in self.capabilities]}
        raise Refused(404, "404 page not found")

    def error(self, refused: Refused) -> dict[str, Any]:
        kind = {404: "not_found_error", 400: "invalid_request_error"}.get(refused.status, "api_error")
        return {"error": {"message": refused.message, "type": kind, "param": None, "code": None}}

    def _model(self, body: Mapping[str, Any]) -> str:
        model = str(body.get("model"))
        found = next((name for name in (model, f"{model}:latest") if name in self.capabilities), None)
        if found is None:
            raise Refused(404, f"model '{model}' not found")
        return found

    def _chat(self, body: dict[str, Any], special: Special) -> dict[str, Any]:
        model = self._model(body)
        require("completion" in self.capabilities[model], f'"{model}" does not support chat')
        shown = any(isinstance(message.get("content"), list) for message in body.get("messages", []))
        require(
            not shown or "vision" in self.capabilities[model], "this model is missing data required for image input"
        )
        return openai.chat(body, special, lambda _: None) | {"model": model, "usage": openai.CHAT_USAGE}
