"""OpenRouter: OpenAI's chat, and pictures with references.

Wire shape: https://openrouter.ai/docs/guides/overview/multimodal/image-generation
"""

from __future__ import annotations

from vcage.models.exchange import Question, Reply
from vcage.models.openai import OpenAiText, drawn, said_at_once
from vcage.models.pictures import data_url
from vcage.models.provider import Client, Provider, bearer


class OpenRouterPicture(Client):
    """Edited pictures over ``images``."""

    def answer(self, question: Question) -> Reply:
        """The edited picture; raises as :meth:`vcage.models.openai.OpenAiPicture.answer`."""
        source = {"type": "image_url", "image_url": {"url": data_url(question.messages[0].pictures[0])}}
        body = {"model": self.model, "prompt": said_at_once(question), "input_references": [source]}
        return drawn(self.post("images", body), self.provider)


OPENROUTER = Provider(
    name="openrouter",
    key_variables=("OPENROUTER_API_KEY",),
    headers=bearer,
    base_url="https://openrouter.ai/api/v1",
    text_model="~google/gemini-pro-latest",
    image_model="google/gemini-nano-banana-2.1",
    lists=("models", "images/models"),
    tells_cost=True,
    text=OpenAiText,
    picture=OpenRouterPicture,
)
