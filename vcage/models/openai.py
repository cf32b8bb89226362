"""OpenAI and all that speaks its language (OpenRouter, vLLM, Ollama…): chat, and picture editing.

Wire shapes: https://platform.openai.com/docs/api-reference/chat, …/images/createEdit, and
https://openrouter.ai/docs/features/multimodal/image-generation
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from vcage.base.errors import EndpointFailed, ModelRefused
from vcage.models.chat import Message
from vcage.models.gemini import edit_prompt
from vcage.models.pictures import decode_base64, encode_base64, encode_png
from vcage.models.protocols import EditRequest
from vcage.models.transport import Transport

BASE_URLS = {"openai": "https://api.openai.com/v1", "openrouter": "https://openrouter.ai/api/v1"}
TEXT_MODELS = {"openai": "gpt-5", "openrouter": "google/gemini-3-pro-preview"}
IMAGE_MODELS = {"openai": "gpt-image-1", "openrouter": "google/gemini-2.5-flash-image"}


class OpenAiChat:
    """Implements :class:`vcage.models.chat.Chat` over ``chat/completions``.

    Args:
        name: the provider's name, for records: ``openai``, ``openrouter``.
    """

    def __init__(self, transport: Transport, model: str, name: str = "openai"):
        self._transport = transport
        self._model = model
        self.provider = f"{name}:{model}"

    def complete(self, messages: Sequence[Message], schema: dict[str, Any]) -> str:
        """See :class:`vcage.models.chat.Chat`; servers that ignore ``response_format`` may answer in a fence."""
        body = {
            "model": self._model,
            "messages": [_message(message) for message in messages],
            "response_format": {
                "type": "json_schema",
                "json_schema": {"name": "answer", "strict": True, "schema": schema},
            },
        }
        message, reason = _first_choice(self._transport.post_json("chat/completions", body), self.provider)
        text = _text(message.get("content"))
        if message.get("refusal") or reason in ("length", "content_filter") or not text:
            why = message.get("refusal") or reason or "no text"
            raise ModelRefused(
                f"{self.provider} gave no whole answer: {why}",
                hint="change the instruction or the model",
                details={"finish_reason": reason},
            )
        return text


class OpenAiEditor:
    """Implements :class:`vcage.models.protocols.ImageEditor` over ``images/edits``."""

    def __init__(self, transport: Transport, model: str = IMAGE_MODELS["openai"], name: str = "openai"):
        self._transport = transport
        self._model = model
        self.provider = f"{name}:{model}"

    def rearrange(self, request: EditRequest) -> np.ndarray:
        """The edited picture, in whatever size the model gives.

        Raises:
            ModelRefused: an answer without a picture.
            EndpointFailed: a picture that cannot be decoded, and see the transport.
        """
        fields = {"model": self._model, "prompt": edit_prompt(request)}
        files = [("image[]", ("source.png", encode_png(request.picture), "image/png"))]
        data = self._transport.post_multipart("images/edits", fields, files)
        items = data.get("data")
        first = items[0] if isinstance(items, list) and items and isinstance(items[0], dict) else {}
        if not first.get("b64_json"):
            raise ModelRefused(
                f"{self.provider} drew no picture", hint="change the instruction, or use --models offline"
            )
        return decode_base64(first["b64_json"], self.provider)


class OpenRouterEditor:
    """Implements :class:`vcage.models.protocols.ImageEditor` over chat with ``modalities``."""

    def __init__(self, transport: Transport, model: str = IMAGE_MODELS["openrouter"], name: str = "openrouter"):
        self._transport = transport
        self._model = model
        self.provider = f"{name}:{model}"

    def rearrange(self, request: EditRequest) -> np.ndarray:
        """The edited picture; raises as :meth:`OpenAiEditor.rearrange`."""
        message = Message("user", edit_prompt(request), (request.picture,))
        body = {"model": self._model, "messages": [_message(message)], "modalities": ["image", "text"]}
        answer, reason = _first_choice(self._transport.post_json("chat/completions", body), self.provider)
        images = answer.get("images") or []
        url = images[0].get("image_url", {}).get("url") if images and isinstance(images[0], dict) else None
        if not url:
            why = answer.get("refusal") or reason or "no reason given"
            raise ModelRefused(
                f"{self.provider} drew no picture: {why}", hint="change the instruction, or use --models offline"
            )
        return decode_base64(url, self.provider)


def _message(message: Message) -> dict[str, Any]:
    role = "assistant" if message.role == "model" else "user"
    if not message.pictures:
        return {"role": role, "content": message.text}
    parts: list[dict[str, Any]] = [{"type": "text", "text": message.text}]
    for picture in message.pictures:
        parts.append({"type": "image_url", "image_url": {"url": f"data:image/png;base64,{encode_base64(picture)}"}})
    return {"role": role, "content": parts}


def _first_choice(data: dict[str, Any], provider: str) -> tuple[dict[str, Any], str]:
    """The first choice's message, and why it ended."""
    choices = data.get("choices")
    choice = choices[0] if isinstance(choices, list) and choices else None
    if not isinstance(choice, dict) or not isinstance(choice.get("message"), dict):
        raise EndpointFailed(f"{provider} answered without a message", hint="check the base URL, or run it again")
    return choice["message"], str(choice.get("finish_reason") or "")


def _text(content: object) -> str:
    """The text of a message, which is a string or a list of parts."""
    if isinstance(content, str):
        return content
    if isinstance(content, list):
        return "".join(str(part.get("text", "")) for part in content if isinstance(part, dict))
    return ""
