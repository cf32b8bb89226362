"""Exchanges stored in a folder: a run that crashed never pays twice, and a replay needs no network.

``<role>-<hash>-<who>.json`` is :class:`vcage.schema.exchange.Exchange`; pictures lie in ``pictures/``, each once.
"""

from __future__ import annotations

import contextlib
import hashlib
import re
import time
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from vcage.base.errors import InputFileError, MissingStage
from vcage.base.pictures import read_picture, write_picture
from vcage.models.exchange import HASH_DIGITS, Answerer, Question, Reply
from vcage.models.spending import Spending, cost
from vcage.schema.exchange import Asked, Exchange, Turn


class Exchanges:
    """A folder of exchanges; the first one creates it.

    Args:
        folder: its path.
        count: returns how many there are; the files are counted by default.
    """

    def __init__(self, folder: Path, count: Callable[[], int] | None = None):
        self.folder = folder
        self._count = count or (lambda: len(list(folder.glob("*.json"))))

    def all(self) -> list[Exchange]:
        """All exchanges, in the order in which they were stored.

        Raises:
            DamagedFile, SchemaMismatch: one cannot be read.
        """
        try:
            return sorted(map(Exchange.read, self.folder.glob("*.json")), key=lambda exchange: exchange.number)
        except InputFileError as error:
            error.hint = "restore it, or remove it: its question is then asked again when it is needed"
            raise

    def find(self, question: Question, provider: str) -> Reply | None:
        """The stored answer of a provider to a question; None if there is none.

        Raises:
            DamagedFile, SchemaMismatch: it cannot be read.
            InputFileError: it was edited since.
        """
        path = self._path(question, provider)
        if not path.exists():
            return None
        stored = Exchange.read(path)
        said = (question.hash, provider, stored.answer, stored.picture)
        if (stored.hash, stored.provider) != said[:2] or stored.seal != Exchange.seal_of(*said):
            raise InputFileError(
                f"{path} was edited: its hash and seal do not fit its question and answer",
                hint="restore it, or remove it and ask again",
                details={"path": str(path)},
            )
        picture = None if stored.picture is None else read_picture(self.folder / "pictures" / stored.picture)
        return Reply(stored.answer, picture, stored.model, stored.tokens_in, stored.tokens_out, stored.usd)

    def store(self, question: Question, reply: Reply, provider: str, seconds: float, usd: float | None) -> None:
        """Store an exchange with its time and cost.

        Raises:
            OutputFolderError: the folder cannot be written.
        """
        path = self._path(question, provider)
        turns = [Turn(speaker=m.speaker, text=m.text, pictures=self._pictures(m.pictures)) for m in question.messages]
        shown = None if reply.picture is None else self._pictures([reply.picture])[0]
        Exchange(
            role=question.role,
            prompt=question.name,
            hash=question.hash,
            turns=turns,
            answer_schema=question.schema,
            provider=provider,
            model=reply.model,
            answer=reply.text,
            picture=shown,
            tokens_in=reply.tokens_in,
            tokens_out=reply.tokens_out,
            usd=usd,
            seconds=round(seconds, 3),
            number=self._number(path),
            seal=Exchange.seal_of(question.hash, provider, reply.text, shown),
        ).write(path)

    def _number(self, path: Path) -> int:
        """The number of the exchange that it replaces, or the next."""
        with contextlib.suppress(InputFileError):
            return Exchange.read(path).number
        return 1 + self._count()

    def _path(self, question: Question, provider: str) -> Path:
        who = re.sub(r"[^a-z0-9.]+", "-", provider.lower()).strip("-")
        return self.folder / f"{question.role}-{question.hash[:HASH_DIGITS]}-{who}.json"

    def _pictures(self, pictures: Sequence[np.ndarray]) -> list[str]:
        names = []
        for picture in pictures:
            name = f"{hashlib.sha256(str(picture.shape).encode() + picture.tobytes()).hexdigest()[:16]}.png"
            path = self.folder / "pictures" / name
            if not path.exists():
                write_picture(path, picture)
            names.append(name)
        return names


class Stored:
    """Implements :class:`vcage.models.exchange.Answerer`: asks another one, and stores its answers.

    Args:
        other: the answerer to ask.
        exchanges: stored answers, reused without asking.
        anew: ask again nevertheless.
        spending: limits on the other one, if it is paid.
    """

    def __init__(self, other: Answerer, exchanges: Exchanges, *, anew: bool = False, spending: Spending | None = None):
        self.provider = other.provider
        self._other, self._exchanges, self._anew, self._spending = other, exchanges, anew, spending

    def answer(self, question: Question) -> Reply:
        """The stored answer, or else a new one.

        Raises:
            SpendingCap: a limit is reached.
            VcageError: as the other one.
        """
        if not self._anew and (stored := self._exchanges.find(question, self.provider)) is not None:
            return stored
        if self._spending is not None:
            self._spending.check()
        start = time.perf_counter()
        reply = self._other.answer(question)
        seconds = time.perf_counter() - start
        usd = reply.usd if self._spending is None else cost(reply, self._spending.price)
        self._exchanges.store(question, reply, self.provider, seconds, usd)
        return reply


class Replayed:
    """Implements :class:`vcage.models.exchange.Answerer`: stored answers, and nothing else.

    Args:
        exchanges: the folder of stored answers.
        provider: the source of the answers.
    """

    def __init__(self, exchanges: Exchanges, provider: str):
        self.provider = provider
        self._exchanges = exchanges

    def answer(self, question: Question) -> Reply:
        """The stored answer.

        Raises:
            MissingStage: the question was not asked before, with these words and pictures.
        """
        stored = self._exchanges.find(question, self.provider)
        if stored is None:
            asked = f"{question.name}, round {question.round}"
            raise MissingStage(
                f"{self._exchanges.folder} holds no answer of {self.provider} to this question ({asked})",
                hint="a replay needs the same instruction, seed, options and version as the run; else ask a model",
                details={"role": question.role, "hash": question.hash},
            )
        return stored


def who_answered(exchanges: Exchanges) -> dict[Asked, str]:
    """The provider that answered first, by role."""
    found: dict[Asked, str] = {}
    for exchange in exchanges.all():
        found.setdefault(exchange.role, exchange.provider)
    return found
