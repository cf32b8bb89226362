"""OpenRouter: OpenAI's chat, and picture editing within it.

Wire shape: https://openrouter.ai/docs/features/multimodal/image-generation
"""

from __future__ import annotations

import numpy as np

from vcage.base.errors import ModelRefused
from vcage.models import prompts
from vcage.models.chat import Message
from vcage.models.openai import OpenAiChat, first_choice, wire_message
from vcage.models.pictures import decode_base64
from vcage.models.protocols import EditRequest
from vcage.models.provider import Client, Provider, bearer


class OpenRouterEditor(Client):
    """Implements :class:`vcage.models.protocols.ImageEditor` over chat with ``modalities``."""

    def rearrange(self, request: EditRequest) -> np.ndarray:
        """The edited picture; raises as :meth:`vcage.models.openai.OpenAiEditor.rearrange`."""
        message = Message("user", prompts.edit_prompt(request), (request.picture,))
        body = {"model": self.model, "messages": [wire_message(message)], "modalities": ["image", "text"]}
        answer, reason = first_choice(self.transport.post_json("chat/completions", body), self.provider)
        images = answer.get("images") or []
        url = images[0].get("image_url", {}).get("url") if images and isinstance(images[0], dict) else None
        if not url:
            why = answer.get("refusal") or reason or "no reason given"
            raise ModelRefused(
                f"{self.provider} drew no picture: {why}", hint="change the instruction, or use --models offline"
            )
        return decode_base64(url, self.provider)


OPENROUTER = Provider(
    name="openrouter",
    key_variables=("OPENROUTER_API_KEY",),
    headers=bearer,
    base_url="https://openrouter.ai/api/v1",
    text_model="google/gemini-3-pro-preview",
    image_model="google/gemini-2.5-flash-image",
    chat=OpenAiChat,
    editor=OpenRouterEditor,
)
