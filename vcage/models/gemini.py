"""Google's Gemini: chat and picture editing (the paper's Nano Banana) over ``generateContent``.

Wire format: https://ai.google.dev/api/generate-content
"""

from __future__ import annotations

from typing import Any

from vcage.models.exchange import Message, Question
from vcage.models.pictures import encode_base64
from vcage.models.provider import Content, Provider, Usage, WireFormat

_RETRYABLE = frozenset(("NO_IMAGE", "STOP", "MAX_TOKENS", "OTHER", "IMAGE_OTHER", "MALFORMED_FUNCTION_CALL", ""))
"""Reasons to finish without a picture that may be gone the next time; all others are refusals."""

_RATIOS = ("1:1", "2:3", "3:2", "3:4", "4:3", "4:5", "5:4", "9:16", "16:9", "21:9")


def _text_body(_: str, question: Question) -> dict[str, Any]:
    return _body(question, {"responseMimeType": "application/json", "responseJsonSchema": question.schema})


def _picture_body(_: str, question: Question) -> dict[str, Any]:
    ratio = _nearest_ratio(question.messages[0].pictures[0].shape)
    return _body(question, {"responseModalities": ["TEXT", "IMAGE"], "imageConfig": {"aspectRatio": ratio}})


def _body(question: Question, config: dict[str, Any]) -> dict[str, Any]:
    contents = [{"role": message.speaker, "parts": _parts(message)} for message in question.messages]
    return {"contents": contents, "generationConfig": config}


def _parts(message: Message) -> list[dict[str, Any]]:
    shown = [{"inlineData": {"mimeType": "image/png", "data": encode_base64(p)}} for p in message.pictures]
    return [*([{"text": message.text}] if message.text else []), *shown]


def _text_content(data: dict[str, Any]) -> Content:
    parts, ended = _first_candidate(data)
    text = "".join(part["text"] for part in parts if isinstance(part.get("text"), str))
    return Content(text, ended=ended, whole=ended in ("STOP", ""))


def _picture_content(data: dict[str, Any]) -> Content:
    parts, ended = _first_candidate(data)
    pictures = [part.get("inlineData") or part.get("inline_data") for part in parts]
    shown = [picture["data"] for picture in pictures if isinstance(picture, dict) and picture.get("data")]
    return Content(picture=next(iter(shown), None), ended=ended, whole=ended in _RETRYABLE)


def _first_candidate(data: dict[str, Any]) -> tuple[list[dict[str, Any]], str]:
    """Its parts without thoughts, and why it ended; where the prompt was blocked, the reason for that."""
    feedback, candidates = data.get("promptFeedback") or {}, data.get("candidates") or []
    blocked = feedback.get("blockReason")
    if not candidates:
        return [], f"blocked, {blocked}" if blocked else ""
    parts = (candidates[0].get("content") or {}).get("parts") or []
    parts = [part for part in parts if isinstance(part, dict) and not part.get("thought")]
    return parts, str(candidates[0].get("finishReason") or "")


def _nearest_ratio(shape: tuple[int, ...]) -> str:
    wanted = shape[1] / shape[0]
    return min(_RATIOS, key=lambda text: abs(int(text.split(":")[0]) / int(text.split(":")[1]) - wanted))


_PATH = "models/{model}:generateContent"
_USAGE = Usage("modelVersion", "usageMetadata", ("promptTokenCount",), ("candidatesTokenCount",), "thoughtsTokenCount")

GEMINI = Provider(
    name="gemini",
    key_variables=("GEMINI_API_KEY", "GOOGLE_API_KEY"),
    headers=lambda key: {"x-goog-api-key": key},
    base_url="https://generativelanguage.googleapis.com",
    text_model="gemini-pro-latest",
    text=WireFormat(_PATH, _text_body, _text_content, usage=_USAGE),
    image_model="gemini-nano-banana-2.1",
    picture=WireFormat(_PATH, _picture_body, _picture_content, usage=_USAGE, rounds=3),
    version="v1beta",
    lists=("models?pageSize=1000",),
)
"""An answer without a picture is normal and passes, so pictures are asked for three times."""
