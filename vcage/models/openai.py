"""OpenAI and all that speaks its language (vLLM…): chat, and picture editing.

Wire shapes: https://platform.openai.com/docs/api-reference/chat, …/images/createEdit
"""

from __future__ import annotations

from typing import Any

import numpy as np

from vcage.base.errors import EndpointFailed, ModelRefused
from vcage.models.exchange import Message, Question, Reply
from vcage.models.pictures import data_url, decode_base64, encode_png
from vcage.models.provider import Client, Provider, bearer, count


class OpenAiText(Client):
    """Answers in JSON over ``chat/completions``."""

    def answer(self, question: Question) -> Reply:
        """See :class:`vcage.models.exchange.Answerer`; servers without ``response_format`` may answer in a fence."""
        body = {
            "model": self.model,
            "messages": [wire_message(message) for message in question.messages],
            "response_format": {
                "type": "json_schema",
                "json_schema": {"name": "answer", "strict": True, "schema": question.schema},
            },
        }
        data = self.post("chat/completions", body)
        message, reason = first_choice(data, self.provider)
        text = _text(message.get("content"))
        if message.get("refusal") or reason in ("length", "content_filter") or not text:
            raise self.cut_off(str(message.get("refusal") or reason))
        return reply(data, text)


class OpenAiPicture(Client):
    """Edited pictures over ``images/edits``."""

    def answer(self, question: Question) -> Reply:
        """The edited picture, in whatever size the model gives.

        Raises:
            ModelRefused: an answer without a picture.
            EndpointFailed: a picture that cannot be decoded, and see the transport.
        """
        fields = {"model": self.model, "prompt": said_at_once(question)}
        source = question.messages[0].pictures[0]
        files = [("image[]", ("source.png", encode_png(source), "image/png"))]
        data = self.post("images/edits", fields, files)
        return drawn(data, self.provider)


def said_at_once(question: Question) -> str:
    """A question for an endpoint without turns: what was wrong with the last picture comes with the first request."""
    return "\n\n".join(message.text for message in question.messages if message.speaker == "user")


def drawn(data: dict[str, Any], provider: str) -> Reply:
    """The reply with the first picture of an answer's ``data``.

    Raises:
        ModelRefused: there is none.
        EndpointFailed: it cannot be decoded.
    """
    items = data.get("data")
    first = items[0] if isinstance(items, list) and items and isinstance(items[0], dict) else {}
    encoded = first.get("b64_json")
    if not isinstance(encoded, str) or not encoded:
        raise ModelRefused(f"{provider} drew no picture", hint="change the instruction, or use --editor offline")
    return reply(data, picture=decode_base64(encoded, provider))


def reply(data: dict[str, Any], text: str = "", picture: np.ndarray | None = None) -> Reply:
    """With the model, tokens and cost that the answer names; chat and pictures count tokens by other names."""
    used = data.get("usage")
    used = used if isinstance(used, dict) else {}
    tokens_in, tokens_out = (
        next((n for name in names if (n := count(used, name)) is not None), None)
        for names in (("prompt_tokens", "input_tokens"), ("completion_tokens", "output_tokens"))
    )
    cost = used.get("cost")
    usd = float(cost) if isinstance(cost, int | float) else None
    return Reply(text, picture, str(data.get("model") or ""), tokens_in, tokens_out, usd)


def wire_message(message: Message) -> dict[str, Any]:
    """A turn as ``chat/completions`` takes it."""
    role = "assistant" if message.speaker == "model" else "user"
    if not message.pictures:
        return {"role": role, "content": message.text}
    parts: list[dict[str, Any]] = [{"type": "text", "text": message.text}]
    for picture in message.pictures:
        parts.append({"type": "image_url", "image_url": {"url": data_url(picture)}})
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
    text_model="gpt-6.1-terra",
    image_model="gpt-image-2",
    lists=("models",),
    text=OpenAiText,
    picture=OpenAiPicture,
)
