"""OpenAI and all that speaks its language (vLLM, Ollama…): chat, and picture editing.

Wire shapes: https://platform.openai.com/docs/api-reference/chat, …/images/createEdit
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from vcage.base.errors import EndpointFailed, ModelRefused
from vcage.models import prompts
from vcage.models.chat import Message
from vcage.models.pictures import decode_base64, encode_base64, encode_png
from vcage.models.protocols import EditRequest
from vcage.models.provider import Client, Provider, bearer


class OpenAiChat(Client):
    """Implements :class:`vcage.models.chat.Chat` over ``chat/completions``."""

    def complete(self, messages: Sequence[Message], schema: dict[str, Any]) -> str:
        """See :class:`vcage.models.chat.Chat`; servers that ignore ``response_format`` may answer in a fence."""
        body = {
            "model": self.model,
            "messages": [wire_message(message) for message in messages],
            "response_format": {
                "type": "json_schema",
                "json_schema": {"name": "answer", "strict": True, "schema": schema},
            },
        }
        message, reason = first_choice(self.transport.post_json("chat/completions", body), self.provider)
        text = _text(message.get("content"))
        if message.get("refusal") or reason in ("length", "content_filter") or not text:
            why = message.get("refusal") or reason or "no text"
            raise ModelRefused(
                f"{self.provider} gave no whole answer: {why}",
                hint="change the instruction or the model",
                details={"finish_reason": reason},
            )
        return text


class OpenAiEditor(Client):
    """Implements :class:`vcage.models.protocols.ImageEditor` over ``images/edits``."""

    def rearrange(self, request: EditRequest) -> np.ndarray:
        """The edited picture, in whatever size the model gives.

        Raises:
            ModelRefused: an answer without a picture.
            EndpointFailed: a picture that cannot be decoded, and see the transport.
        """
        fields = {"model": self.model, "prompt": prompts.edit_prompt(request)}
        files = [("image[]", ("source.png", encode_png(request.picture), "image/png"))]
        data = self.transport.post_multipart("images/edits", fields, files)
        items = data.get("data")
        first = items[0] if isinstance(items, list) and items and isinstance(items[0], dict) else {}
        if not first.get("b64_json"):
            raise ModelRefused(
                f"{self.provider} drew no picture", hint="change the instruction, or use --models offline"
            )
        return decode_base64(first["b64_json"], self.provider)


def wire_message(message: Message) -> dict[str, Any]:
    """A turn as ``chat/completions`` takes it."""
    role = "assistant" if message.role == "model" else "user"
    if not message.pictures:
        return {"role": role, "content": message.text}
    parts: list[dict[str, Any]] = [{"type": "text", "text": message.text}]
    for picture in message.pictures:
        parts.append({"type": "image_url", "image_url": {"url": f"data:image/png;base64,{encode_base64(picture)}"}})
    return {"role": role, "content": parts}


def first_choice(data: dict[str, Any], provider: str) -> tuple[dict[str, Any], str]:
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


OPENAI = Provider(
    name="openai",
    key_variables=("OPENAI_API_KEY",),
    headers=bearer,
    base_url="https://api.openai.com/v1",
    text_model="gpt-5",
    image_model="gpt-image-1",
    chat=OpenAiChat,
    editor=OpenAiEditor,
)
