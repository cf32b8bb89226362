"""An endpoint's answer over HTTP, and the errors that its status and its own codes stand for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from vcage.base.errors import ConfigurationError, ModelRefused
from vcage.base.reading import load_json

_CONFIGURATION = {
    400: ("the endpoint does not accept the request", "check the model id and the base URL"),
    401: ("the endpoint does not accept the key", "check the key"),
    402: ("the account has no credit", "top up the account, or use another provider"),
    403: ("the key may not use this model", "check the key's permissions and the model id"),
    404: ("the endpoint has no such model or path", "check the model id and the base URL"),
    413: ("the request is too large for the endpoint", "use smaller pictures"),
    422: ("the endpoint does not accept the request", "check the model id"),
}

WRONG_KEY = "API_KEY_INVALID"
"""Gemini's code for a wrong key, with status 400."""

NO_CREDIT = "insufficient_quota"
"""OpenAI's code for an account without credit, with status 429."""

TOO_LONG = ("context_length_exceeded", "exceed_context_size_error")
"""OpenAI's code and llama.cpp's type for a question that is longer than the model's context, with status 400."""

BLOCKED = ("moderation_blocked", "content_policy_violation", "content_filter")
"""Codes of OpenAI and others for content that is not allowed, with status 400."""


@dataclass(frozen=True)
class EndpointAnswer:
    """An answer of an endpoint."""

    status: int
    headers: Mapping[str, str]
    body: bytes

    @property
    def text(self) -> str:
        """The beginning of it, for a person."""
        return self.body[:1000].decode(errors="replace")

    @cached_property
    def data(self) -> object:
        """The JSON; None where it is none."""
        try:
            return load_json(self.body)
        except (ValueError, RecursionError):
            return None

    @property
    def error(self) -> dict[str, Any]:
        """The object that describes an error."""
        error = self.data.get("error") if isinstance(self.data, dict) else None
        return error if isinstance(error, dict) else {"message": error}

    @property
    def transient(self) -> bool:
        """True if the same request may succeed later."""
        passing = self.status < 300 or self.status in (408, 429) or self.status >= 500
        return passing and self.error.get("code") != NO_CREDIT

    @property
    def blocked(self) -> bool:
        """True if OpenAI or OpenRouter says that the content is not allowed."""
        metadata = self.error.get("metadata")
        return self.error.get("code") in BLOCKED or (isinstance(metadata, dict) and bool(metadata.get("reasons")))


def final_error(answer: EndpointAnswer, problem: str) -> ConfigurationError | ModelRefused:
    """The error about an answer that would come again.

    Args:
        answer: with a status that means failure.
        problem: the same in words, without secrets.
    """
    details = {"status": answer.status}
    status = answer.status
    if answer.blocked:
        return ModelRefused(f"the request is blocked: {problem}", hint="change the instruction", details=details)
    if answer.error.get("code") in TOO_LONG or answer.error.get("type") in TOO_LONG:
        hint = "take a model with a longer context, or start its server with one"
        return ConfigurationError(f"the question is too long for the model: {problem}", hint=hint, details=details)
    if answer.error.get("code") == NO_CREDIT:
        status = 402
    elif WRONG_KEY in str(answer.error.get("details")):
        status = 401
    if status in _CONFIGURATION or 300 <= status < 400:
        what, hint = _CONFIGURATION.get(status, ("the endpoint redirects", "check the base URL"))
        return ConfigurationError(f"{what}: {problem}", hint=hint, details=details)
    return ModelRefused(problem, hint="change the instruction or the model", details=details)
