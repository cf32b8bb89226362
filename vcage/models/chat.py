"""What the reasoning and judging code needs of a chat endpoint, so that all providers share it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal, Protocol

import numpy as np


@dataclass(frozen=True)
class Message:
    """One turn: text, then pictures (H, W, 3) uint8 RGB."""

    role: Literal["user", "model"]
    text: str
    pictures: tuple[np.ndarray, ...] = ()


class Chat(Protocol):
    """A model that answers in JSON."""

    provider: str

    def complete(self, messages: Sequence[Message], schema: dict[str, Any]) -> str:
        """The text of the answer to the conversation; ``schema`` is the JSON Schema that it should follow.

        Raises:
            ModelRefused: a refusal, a safety block, or an answer that was cut off.
            EndpointFailed, ConfigurationError: see :class:`vcage.models.transport.Transport`.
        """
        ...
