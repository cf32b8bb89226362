"""Google's Gemini: chat and picture editing over ``generateContent``.

Wire shape: https://ai.google.dev/api/generate-content
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from vcage.base.errors import EndpointFailed, ModelRefused
from vcage.models import prompts
from vcage.models.chat import Message
from vcage.models.pictures import decode_base64, encode_base64
from vcage.models.protocols import EditRequest
from vcage.models.provider import Client, Provider

PICTURE_ROUNDS = 3
"""How often a picture is asked for: an answer without one is normal and passes."""

_PASSING = frozenset(("NO_IMAGE", "STOP", "MAX_TOKENS", "OTHER", "IMAGE_OTHER", "MALFORMED_FUNCTION_CALL", ""))
"""Reasons to finish without a picture that may be gone the next time; all others are refusals."""

_RATIOS = ("1:1", "2:3", "3:2", "3:4", "4:3", "4:5", "5:4", "9:16", "16:9", "21:9")


class GeminiChat(Client):
    """Implements :class:`vcage.models.chat.Chat`."""

    def complete(self, messages: Sequence[Message], schema: dict[str, Any]) -> str:
        """See :class:`vcage.models.chat.Chat`."""
        body = {
            "contents": [{"role": m.role, "parts": _parts(m.text, m.pictures)} for m in messages],
            "generationConfig": {"responseMimeType": "application/json", "responseJsonSchema": schema},
        }
        parts, reason = _generate(self, body)
        text = "".join(part["text"] for part in parts if isinstance(part.get("text"), str) and not part.get("thought"))
        if not text or reason not in ("STOP", ""):
            raise ModelRefused(
                f"{self.provider} gave no whole answer: {reason or 'no text'}",
                hint="change the instruction or the model",
                details={"finish_reason": reason},
            )
        return text


class GeminiEditor(Client):
    """Implements :class:`vcage.models.protocols.ImageEditor` (the paper's Nano Banana)."""

    def rearrange(self, request: EditRequest) -> np.ndarray:
        """The edited picture, in whatever size the model gives.

        Raises:
            ModelRefused: a safety block, or no picture after all rounds.
            EndpointFailed: a picture that cannot be decoded, and see the transport.
        """
        ratio = _nearest_ratio(request.picture.shape)
        body = {
            "contents": [{"role": "user", "parts": _parts(prompts.edit_prompt(request), (request.picture,))}],
            "generationConfig": {"responseModalities": ["TEXT", "IMAGE"], "imageConfig": {"aspectRatio": ratio}},
        }
        reason = ""
        for _ in range(PICTURE_ROUNDS):
            parts, reason = _generate(self, body)
            pictures = [part.get("inlineData") or part.get("inline_data") for part in parts if not part.get("thought")]
            data = next((p["data"] for p in pictures if isinstance(p, dict) and p.get("data")), None)
            if data is not None:
                return decode_base64(data, self.provider)
            if reason not in _PASSING:
                break
        raise ModelRefused(
            f"{self.provider} drew no picture: {reason or 'no reason given'}",
            hint="change the instruction, or use --models offline",
            details={"finish_reason": reason},
        )


def _parts(text: str, pictures: Sequence[np.ndarray]) -> list[dict[str, Any]]:
    data = [{"inlineData": {"mimeType": "image/png", "data": encode_base64(picture)}} for picture in pictures]
    return [{"text": text}, *data]


def _generate(client: Client, body: Mapping[str, Any]) -> tuple[list[dict[str, Any]], str]:
    """Parts of the first candidate, and why it ended.

    Raises:
        ModelRefused: the prompt itself was blocked.
        EndpointFailed: the answer is of another shape.
    """
    version = "" if client.transport.base_url.endswith(("/v1", "/v1beta")) else "v1beta/"
    data = client.transport.post_json(f"{version}models/{client.model}:generateContent", body)
    feedback = data.get("promptFeedback") or {}
    candidates = data.get("candidates") or []
    if feedback.get("blockReason") and not candidates:
        raise ModelRefused(
            f"{client.provider} blocked the request: {feedback['blockReason']}", hint="change the instruction"
        )
    try:
        candidate = candidates[0] if candidates else {}
        parts = (candidate.get("content") or {}).get("parts") or []
        return [part for part in parts if isinstance(part, dict)], str(candidate.get("finishReason") or "")
    except (AttributeError, TypeError, KeyError) as error:
        raise EndpointFailed(f"{client.provider} answered in an unknown shape", hint="check the base URL") from error


def _nearest_ratio(shape: tuple[int, ...]) -> str:
    wanted = shape[1] / shape[0]
    return min(_RATIOS, key=lambda text: abs(int(text.split(":")[0]) / int(text.split(":")[1]) - wanted))


GEMINI = Provider(
    name="gemini",
    key_variables=("GEMINI_API_KEY", "GOOGLE_API_KEY"),
    headers=lambda key: {"x-goog-api-key": key},
    base_url="https://generativelanguage.googleapis.com",
    text_model="gemini-3-pro-preview",
    image_model="gemini-3-pro-image",
    chat=GeminiChat,
    editor=GeminiEditor,
)
