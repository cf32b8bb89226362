"""What is particular to a provider of models online; one file each says it (``gemini``, ``openai``, ``openrouter``)."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from vcage.models.exchange import Answerer
from vcage.models.transport import Transport


class Client:
    """One model behind an endpoint.

    Args:
        model: its id, as the endpoint spells it.
        provider: what records call it: ``openai:gpt-6.1-terra``.
    """

    def __init__(self, transport: Transport, model: str, provider: str):
        self.transport = transport
        self.model = model
        self.provider = provider


@dataclass(frozen=True)
class Provider:
    """An endpoint, how it takes a key, and the clients that speak its language.

    Args:
        name: as ``--models`` spells it.
        key_variables: environment variables that its own tools read the key from.
        headers: what carries a key in a request.
        base_url, text_model, image_model: where ``VCAGE_<NAME>_BASE_URL``, ``…_TEXT_MODEL`` and ``…_IMAGE_MODEL`` do
            not name others.
        text, picture: made from transport, model and the name for records.
    """

    name: str
    key_variables: tuple[str, ...]
    headers: Callable[[str], dict[str, str]]
    base_url: str
    text_model: str
    image_model: str
    text: Callable[[Transport, str, str], Answerer]
    picture: Callable[[Transport, str, str], Answerer]

    def connect(self, key: str) -> tuple[Answerer, Answerer]:
        """What answers in text, and what answers in pictures; nothing is sent yet.

        Raises:
            ConfigurationError: the base URL that was set is none.
        """
        transport = Transport(self._setting("BASE_URL", self.base_url), self.headers(key))
        text, image = self._setting("TEXT_MODEL", self.text_model), self._setting("IMAGE_MODEL", self.image_model)
        return self.text(transport, text, f"{self.name}:{text}"), self.picture(transport, image, f"{self.name}:{image}")

    def _setting(self, what: str, default: str) -> str:
        return os.environ.get(f"VCAGE_{self.name.upper()}_{what}") or default


def count(used: Mapping[str, object], name: str) -> int | None:
    """A number of tokens in an answer; None where it says none."""
    value = used.get(name)
    return value if isinstance(value, int) else None


def bearer(key: str) -> dict[str, str]:
    """The header of RFC 6750, which most endpoints take."""
    return {"Authorization": f"Bearer {key}"}
