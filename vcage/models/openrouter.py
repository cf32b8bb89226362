"""OpenRouter: OpenAI's chat, and picture editing with references.

Wire shape: https://openrouter.ai/docs/features/multimodal/image-generation
"""

from __future__ import annotations

from vcage.base.errors import ModelRefused
from vcage.models.exchange import Question, Reply
from vcage.models.openai import OpenAiText, first_choice, reply, wire_message
from vcage.models.pictures import decode_base64
from vcage.models.provider import Client, Provider, bearer


class OpenRouterPicture(Client):
    """Implements :class:`vcage.models.exchange.Answerer` for edited pictures over chat with ``modalities``."""

    def answer(self, question: Question) -> Reply:
        """The edited picture; raises as :meth:`vcage.models.openai.OpenAiPicture.answer`."""
        messages = [wire_message(message) for message in question.messages]
        body = {"model": self.model, "messages": messages, "modalities": ["image", "text"]}
        data = self.transport.post_json("chat/completions", body)
        answer, reason = first_choice(data, self.provider)
        images = answer.get("images") or []
        url = images[0].get("image_url", {}).get("url") if images and isinstance(images[0], dict) else None
        if not url:
            why = answer.get("refusal") or reason or "no reason given"
            raise ModelRefused(
                f"{self.provider} drew no picture: {why}", hint="change the instruction, or use --models offline"
            )
        return reply(data, picture=decode_base64(url, self.provider))


OPENROUTER = Provider(
    name="openrouter",
    key_variables=("OPENROUTER_API_KEY",),
    headers=bearer,
    base_url="https://openrouter.ai/api/v1",
    text_model="~google/gemini-pro-latest",
    image_model="google/gemini-nano-banana-2.1",
    text=OpenAiText,
    picture=OpenRouterPicture,
)
