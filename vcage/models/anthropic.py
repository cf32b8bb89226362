"""Anthropic's messages: text from text and pictures; it draws none.

Wire format: https://platform.claude.com/docs/en/api/messages, …/build-with-claude/structured-outputs
"""

from __future__ import annotations

from typing import Any

from vcage.models.exchange import Message, Question
from vcage.models.pictures import encode_base64
from vcage.models.provider import Content, Provider, WireFormat

MAX_TOKENS = 16_000
"""Limit on an answer with the thoughts before it; the endpoint requires one."""


def _body(model: str, question: Question) -> dict[str, Any]:
    return {
        "model": model,
        "max_tokens": MAX_TOKENS,
        "messages": [_message(message) for message in question.messages],
        "output_config": {"format": {"type": "json_schema", "schema": question.schema}},
    }


def _message(message: Message) -> dict[str, Any]:
    sources = [
        {"type": "base64", "media_type": "image/png", "data": encode_base64(picture)} for picture in message.pictures
    ]
    shown = [{"type": "image", "source": source} for source in sources]
    role = "assistant" if message.speaker == "model" else "user"
    return {"role": role, "content": [{"type": "text", "text": message.text}, *shown]}


def _content(data: dict[str, Any]) -> Content:
    text = "".join(block["text"] for block in data.get("content") or () if block.get("type") == "text")
    ended = str(data.get("stop_reason") or "")
    return Content(text, ended=ended, whole=ended in ("end_turn", "stop_sequence", ""))


ANTHROPIC = Provider(
    name="anthropic",
    key_variables=("ANTHROPIC_API_KEY",),
    headers=lambda key: {"x-api-key": key, "anthropic-version": "2023-06-01"},
    base_url="https://api.anthropic.com",
    text_model="claude-sonnet-5-5",
    text=WireFormat("messages", _body, _content),
    version="v1",
    lists=("models?limit=1000",),
)
