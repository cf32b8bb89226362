"""OpenRouter: OpenAI's chat, and pictures with references.

Wire format: https://openrouter.ai/docs/guides/overview/multimodal/image-generation
"""

from __future__ import annotations

from typing import Any

from vcage.models.exchange import Question
from vcage.models.openai import CHAT, first_picture, prompt_of
from vcage.models.pictures import data_url
from vcage.models.provider import Provider, WireFormat, bearer


def _picture_body(model: str, question: Question) -> dict[str, Any]:
    source = {"type": "image_url", "image_url": {"url": data_url(question.messages[0].pictures[0])}}
    return {"model": model, "prompt": prompt_of(question), "input_references": [source]}


OPENROUTER = Provider(
    name="openrouter",
    key_variables=("OPENROUTER_API_KEY",),
    headers=bearer,
    base_url="https://openrouter.ai/api/v1",
    text_model="~google/gemini-pro-latest",
    text=CHAT,
    image_model="google/gemini-nano-banana-2.1",
    picture=WireFormat("images", _picture_body, first_picture),
    lists=("models", "images/models"),
    reports_cost=True,
)
