"""Google's Gemini: chat and picture editing over ``generateContent``.

Wire shape: https://ai.google.dev/api/generate-content
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from vcage.base.errors import EndpointFailed, ModelRefused
from vcage.models.exchange import Question, Reply
from vcage.models.pictures import decode_base64, encode_base64
from vcage.models.provider import Client, Provider, count

PICTURE_ROUNDS = 3
"""How often a picture is asked for: an answer without one is normal and passes."""

_PASSING = frozenset(("NO_IMAGE", "STOP", "MAX_TOKENS", "OTHER", "IMAGE_OTHER", "MALFORMED_FUNCTION_CALL", ""))
"""Reasons to finish without a picture that may be gone the next time; all others are refusals."""

_RATIOS = ("1:1", "2:3", "3:2", "3:4", "4:3", "4:5", "5:4", "9:16", "16:9", "21:9")


class GeminiText(Client):
    """Answers in JSON."""

    def answer(self, question: Question) -> Reply:
        """See :class:`vcage.models.exchange.Answerer`."""
        config = {"responseMimeType": "application/json", "responseJsonSchema": question.schema}
        data = _generate(self, {"contents": _contents(question), "generationConfig": config})
        parts, reason = _first_candidate(data, self.provider)
        text = "".join(part["text"] for part in parts if isinstance(part.get("text"), str) and not part.get("thought"))
        if not text or reason not in ("STOP", ""):
            raise self.cut_off(reason)
        return _reply(data, text)


class GeminiPicture(Client):
    """Edited pictures (the paper's Nano Banana)."""

    def answer(self, question: Question) -> Reply:
        """The edited picture, in whatever size the model gives.

        Raises:
            ModelRefused: a safety block, or no picture after all rounds.
            EndpointFailed: a picture that cannot be decoded, and see the transport.
        """
        ratio = _nearest_ratio(question.messages[0].pictures[0].shape)
        config = {"responseModalities": ["TEXT", "IMAGE"], "imageConfig": {"aspectRatio": ratio}}
        reason = ""
        for _ in range(PICTURE_ROUNDS):
            answered = _generate(self, {"contents": _contents(question), "generationConfig": config})
            parts, reason = _first_candidate(answered, self.provider)
            pictures = [part.get("inlineData") or part.get("inline_data") for part in parts if not part.get("thought")]
            data = next((p["data"] for p in pictures if isinstance(p, dict) and p.get("data")), None)
            if data is not None:
                return _reply(answered, picture=decode_base64(data, self.provider))
            if reason not in _PASSING:
                break
        raise ModelRefused(
            f"{self.provider} drew no picture: {reason or 'no reason given'}",
            hint="change the instruction, or use --models offline",
            details={"finish_reason": reason},
        )


def _contents(question: Question) -> list[dict[str, Any]]:
    return [{"role": m.speaker, "parts": _parts(m.text, m.pictures)} for m in question.messages]


def _parts(text: str, pictures: Sequence[np.ndarray]) -> list[dict[str, Any]]:
    data = [{"inlineData": {"mimeType": "image/png", "data": encode_base64(picture)}} for picture in pictures]
    return [*([{"text": text}] if text else []), *data]


def _generate(client: Client, body: Mapping[str, Any]) -> dict[str, Any]:
    return client.post(f"models/{client.model}:generateContent", body)


def _reply(data: dict[str, Any], text: str = "", picture: np.ndarray | None = None) -> Reply:
    used = data.get("usageMetadata")
    used = used if isinstance(used, dict) else {}
    thought = count(used, "thoughtsTokenCount") or 0
    out = count(used, "candidatesTokenCount")
    model = str(data.get("modelVersion") or "")
    return Reply(text, picture, model, count(used, "promptTokenCount"), None if out is None else out + thought)


def _first_candidate(data: dict[str, Any], provider: str) -> tuple[list[dict[str, Any]], str]:
    """Its parts, and why it ended.

    Raises:
        ModelRefused: the prompt itself was blocked.
        EndpointFailed: the answer is of another shape.
    """
    feedback, candidates = data.get("promptFeedback") or {}, data.get("candidates") or []
    try:
        if not candidates and (blocked := feedback.get("blockReason")):
            raise ModelRefused(f"{provider} blocked the request: {blocked}", hint="change the instruction")
        candidate = candidates[0] if candidates else {}
        parts = (candidate.get("content") or {}).get("parts") or []
        return [part for part in parts if isinstance(part, dict)], str(candidate.get("finishReason") or "")
    except (AttributeError, TypeError, KeyError) as error:
        raise EndpointFailed(f"{provider} answered in an unknown shape", hint="check the base URL") from error


def _nearest_ratio(shape: tuple[int, ...]) -> str:
    wanted = shape[1] / shape[0]
    return min(_RATIOS, key=lambda text: abs(int(text.split(":")[0]) / int(text.split(":")[1]) - wanted))


GEMINI = Provider(
    name="gemini",
    key_variables=("GEMINI_API_KEY", "GOOGLE_API_KEY"),
    headers=lambda key: {"x-goog-api-key": key},
    base_url="https://generativelanguage.googleapis.com",
    version="v1beta",
    lists=("models?pageSize=1000",),
    text_model="gemini-pro-latest",
    image_model="gemini-nano-banana-2.1",
    text=GeminiText,
    picture=GeminiPicture,
)
