"""Exchanges with models: an agent, an endpoint and a record take the same questions and give the same replies.

The hash of a question covers its role, its turns with their pictures, and the schema of the answer.
:mod:`vcage.models.exchanges` stores exchanges by that hash.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Literal, Protocol

import numpy as np

from vcage.schema.exchange import Asked

HASH_DIGITS = 12
"""Digits of a hash in a file's name."""

MAX_CHARACTERS_SENT_BACK = 20_000
"""Characters of a wrong answer that go back with the complaint."""


@dataclass(frozen=True)
class Message:
    """One turn: text, then pictures (H, W, 3) uint8 RGB."""

    speaker: Literal["user", "model"]
    text: str
    pictures: tuple[np.ndarray, ...] = ()


@dataclass(frozen=True)
class Question:
    """A question to a model.

    Args:
        role: the role that should answer.
        messages: the turns so far; the last one is the user's.
        schema: JSON Schema of the answer; None asks for a picture.
        name: name of the prompt, ``prompts/<name>.md``.
        captions: one for each picture of the first turn.
        vote: number of the repetition, from 1.
    """

    role: Asked
    messages: tuple[Message, ...]
    schema: dict[str, Any] | None
    name: str
    captions: tuple[str, ...] = ()
    vote: int = 1

    @property
    def round(self) -> int:
        """The number of the round: 1, and one more for each complaint."""
        return (len(self.messages) + 1) // 2

    @property
    def first(self) -> Question:
        """The question of the first round."""
        return replace(self, messages=self.messages[:1])

    def again(self, reply: Reply, complaint: str) -> Question:
        """The next round."""
        pictures = () if reply.picture is None else (reply.picture,)
        turns = Message("model", reply.text[:MAX_CHARACTERS_SENT_BACK], pictures), Message("user", complaint)
        return replace(self, messages=(*self.messages, *turns))

    @property
    def label(self) -> str:
        """Its name in files: the role, and the beginning of the first round's hash."""
        return f"{self.role}-{self.first.hash[:HASH_DIGITS]}"

    @cached_property
    def hash(self) -> str:
        """Hex SHA-256 of role, turns and schema, and of the vote after the first."""
        votes = [self.vote] if self.vote > 1 else []
        digest = hashlib.sha256(json.dumps([self.role, self.schema, *votes], sort_keys=True).encode())
        for message in self.messages:
            digest.update(json.dumps([message.speaker, message.text]).encode())
            for picture in message.pictures:
                digest.update(str(picture.shape).encode() + np.ascontiguousarray(picture).tobytes())
        return digest.hexdigest()


@dataclass(frozen=True)
class Reply:
    """An answer to a question.

    Args:
        text: of the answer, or beside a picture.
        picture: (H, W, 3) uint8 RGB, of any size.
        model: version, as the reply names it.
        tokens_in, tokens_out: as the reply counts them.
        usd: cost, if the reply says it.
    """

    text: str = ""
    picture: np.ndarray | None = None
    model: str = ""
    tokens_in: int | None = None
    tokens_out: int | None = None
    usd: float | None = None

    def __post_init__(self) -> None:
        """JSON can hold halves of characters, which no file can."""
        object.__setattr__(self, "text", self.text.encode(errors="replace").decode())


class Answerer(Protocol):
    """A model, a person, a record."""

    provider: str

    def answer(self, question: Question) -> Reply:
        """The reply.

        Raises:
            ModelRefused: a refusal, a safety block, an answer that was cut off, or no picture.
            AnswerNeeded: the answer is to be written first.
            EndpointFailed, ConfigurationError: see :class:`vcage.models.transport.Transport`.
        """
        ...
