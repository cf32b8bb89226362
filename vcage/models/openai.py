"""OpenAI and the servers that speak its language (vLLM…): chat, and picture editing.

Wire formats: https://platform.openai.com/docs/api-reference/chat, …/images/createEdit
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from vcage.models.exchange import Message, Question
from vcage.models.pictures import data_url, encode_png
from vcage.models.provider import Content, Provider, WireFormat, bearer
from vcage.models.transport import FilePart


def _chat_body(model: str, question: Question) -> dict[str, Any]:
    schema = {"name": "answer", "strict": True, "schema": question.schema}
    return {
        "model": model,
        "messages": [_chat_message(message) for message in question.messages],
        "response_format": {"type": "json_schema", "json_schema": schema},
    }


def _chat_message(message: Message) -> dict[str, Any]:
    role = "assistant" if message.speaker == "model" else "user"
    if not message.pictures:
        return {"role": role, "content": message.text}
    shown = [{"type": "image_url", "image_url": {"url": data_url(picture)}} for picture in message.pictures]
    return {"role": role, "content": [{"type": "text", "text": message.text}, *shown]}


def _chat_content(data: dict[str, Any]) -> Content:
    """The first choice; its text is a string or a list of parts."""
    choice = data["choices"][0]
    message, ended = choice["message"], str(choice.get("finish_reason") or "")
    text, refusal = message.get("content"), message.get("refusal")
    if isinstance(text, list):
        text = "".join(str(part.get("text", "")) for part in text if isinstance(part, dict))
    whole = not refusal and ended not in ("length", "content_filter")
    return Content(text if isinstance(text, str) else "", ended=str(refusal or ended), whole=whole)


def prompt_of(question: Question) -> str:
    """The question for an endpoint without turns: complaints about earlier pictures follow the first request."""
    return "\n\n".join(message.text for message in question.messages if message.speaker == "user")


def first_picture(data: dict[str, Any]) -> Content:
    """The first picture of an answer's ``data``."""
    items = data.get("data") or [{}]
    return Content(picture=items[0].get("b64_json"))


def _source_file(question: Question) -> Sequence[FilePart]:
    return [("image[]", ("source.png", encode_png(question.messages[0].pictures[0]), "image/png"))]


CHAT = WireFormat("chat/completions", _chat_body, _chat_content)
"""OpenAI's chat, which many servers understand."""

OPENAI = Provider(
    name="openai",
    key_variables=("OPENAI_API_KEY",),
    headers=bearer,
    base_url="https://api.openai.com/v1",
    text_model="gpt-6.1-terra",
    text=CHAT,
    image_model="gpt-image-2",
    picture=WireFormat(
        "images/edits",
        lambda model, question: {"model": model, "prompt": prompt_of(question)},
        first_picture,
        files=_source_file,
    ),
)
