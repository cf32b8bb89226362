"""One exchange with a model, as it is kept under a run."""

from __future__ import annotations

import hashlib
import json
from typing import Any, ClassVar, Literal

from pydantic import Field

from vcage.schema.base import Document, FileName, Record

Asked = Literal["reasoner", "editor", "critic"]
"""The roles that answer questions."""


class Turn(Record):
    """One turn of an exchange."""

    speaker: Literal["user", "model"]
    text: str
    pictures: list[FileName] = Field(default=[], description="names of files in pictures/, PNG")


class Exchange(Document):
    """A question, its answer, and its cost."""

    SCHEMA: ClassVar[str] = "vcage.exchange/1"

    role: Asked
    prompt: str = Field(description="name of the file in prompts/")
    hash: str = Field(description="SHA-256 of role, turns and answer schema")
    turns: list[Turn]
    answer_schema: dict[str, Any] | None = Field(description="JSON Schema of the answer; none where it is a picture")
    provider: str = Field(description="who was asked")
    model: str = Field(description="version, as the reply names it; empty where it does not")
    answer: str
    picture: FileName | None = Field(description="name of a file in pictures/, PNG, where the answer is one")
    tokens_in: int | None
    tokens_out: int | None
    usd: float | None = Field(default=None, description="US dollars, as the reply says, or tokens by known prices")
    seconds: float = Field(description="that the answer took; 0 where it lay there already")
    number: int = Field(description="counts the exchanges of a run, from 1")
    seal: str = Field(description="SHA-256 of hash, provider, answer and picture: no other answer is repeated")

    @staticmethod
    def seal_of(asked: str, provider: str, answer: str, picture: str | None) -> str:
        """The right value of :attr:`seal`; ``asked`` is :attr:`hash`."""
        return hashlib.sha256(json.dumps([asked, provider, answer, picture]).encode()).hexdigest()

    @property
    def online(self) -> bool:
        """True if an endpoint answered, and not an agent."""
        return ":" in self.provider

    @property
    def round(self) -> int:
        """1, and one more for each answer before that came back with a complaint."""
        return (len(self.turns) + 1) // 2
