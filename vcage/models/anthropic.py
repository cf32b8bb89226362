"""Anthropic's messages: text from text and pictures; it draws none.

Wire shape: https://platform.claude.com/docs/en/api/messages, …/build-with-claude/structured-outputs
"""

from __future__ import annotations

from typing import Any

from vcage.models.exchange import Message, Question, Reply
from vcage.models.pictures import encode_base64
from vcage.models.provider import Client, Provider, count

MOST_TOKENS = 16_000
"""Of an answer and the thoughts before it; the endpoint wants a bound."""


class AnthropicText(Client):
    """Answers in JSON over ``messages``."""

    def answer(self, question: Question) -> Reply:
        """See :class:`vcage.models.exchange.Answerer`."""
        data = self.post(
            "messages",
            {
                "model": self.model,
                "max_tokens": MOST_TOKENS,
                "messages": [_wire_message(message) for message in question.messages],
                "output_config": {"format": {"type": "json_schema", "schema": question.schema}},
            },
        )
        content = data.get("content")
        blocks = [b for b in content if isinstance(b, dict)] if isinstance(content, list) else []
        text = "".join(b["text"] for b in blocks if b.get("type") == "text" and isinstance(b.get("text"), str))
        reason = str(data.get("stop_reason") or "")
        if not text or reason not in ("end_turn", "stop_sequence", ""):
            raise self.cut_off(reason)
        used = data.get("usage") if isinstance(data.get("usage"), dict) else {}
        return Reply(
            text,
            model=str(data.get("model") or ""),
            tokens_in=count(used, "input_tokens"),
            tokens_out=count(used, "output_tokens"),
        )


def _wire_message(message: Message) -> dict[str, Any]:
    parts: list[dict[str, Any]] = [{"type": "text", "text": message.text}]
    for picture in message.pictures:
        source = {"type": "base64", "media_type": "image/png", "data": encode_base64(picture)}
        parts.append({"type": "image", "source": source})
    return {"role": "assistant" if message.speaker == "model" else "user", "content": parts}


ANTHROPIC = Provider(
    name="anthropic",
    key_variables=("ANTHROPIC_API_KEY",),
    headers=lambda key: {"x-api-key": key, "anthropic-version": "2023-06-01"},
    base_url="https://api.anthropic.com",
    version="v1",
    text_model="claude-sonnet-5-5",
    image_model="",
    lists=("models?limit=1000",),
    text=AnthropicText,
    picture=None,
)
