"""A provider of models: its endpoint, its key, and the wire formats of its questions and answers.

Each provider is declared in a file of its own (``gemini``, ``openai``…); docs/adding-a-provider.md shows how.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from vcage.base.errors import ConfigurationError, EndpointFailed, ModelNotServed, ModelRefused
from vcage.models.exchange import Question, Reply
from vcage.models.pictures import decode_base64
from vcage.models.served import Served, not_served
from vcage.models.transport import FilePart, Transport, TransportLimits

QUICK = TransportLimits(connect_s=5.0, read_s=10.0)
"""Limits where only the list of models is requested."""


@dataclass(frozen=True)
class Content:
    """Contents of an endpoint's answer.

    Args:
        text: of the answer, without thoughts.
        picture: in base64; None if there is none.
        ended: the reason to stop, as the endpoint names it.
        whole: False if the model declined or was cut off.
    """

    text: str = ""
    picture: object = None
    ended: str = ""
    whole: bool = True


@dataclass(frozen=True)
class Usage:
    """Fields in which an answer names the model's version and counts tokens.

    Args:
        version: field with the version.
        counts: field with the object that counts tokens, and perhaps the cost in US dollars as ``cost``.
        tokens_in, tokens_out: its fields; the first present one counts.
        thoughts: its field for tokens of thoughts, where ``tokens_out`` leaves them out.
    """

    version: str = "model"
    counts: str = "usage"
    tokens_in: tuple[str, ...] = ("prompt_tokens", "input_tokens")
    tokens_out: tuple[str, ...] = ("completion_tokens", "output_tokens")
    thoughts: str = ""

    def reply(self, data: Mapping[str, Any], text: str = "", picture: np.ndarray | None = None) -> Reply:
        """The reply with the version, tokens and cost that an answer names."""
        counts = data.get(self.counts)
        counts = counts if isinstance(counts, dict) else {}
        cost = counts.get("cost")
        out = _count(counts, *self.tokens_out)
        return Reply(
            text,
            picture,
            model=str(data.get(self.version) or ""),
            tokens_in=_count(counts, *self.tokens_in),
            tokens_out=None if out is None else out + (_count(counts, self.thoughts) or 0),
            usd=float(cost) if isinstance(cost, int | float) else None,
        )


def _count(counts: Mapping[str, object], *names: str) -> int | None:
    """The number of tokens in the first of some fields that has one."""
    return next((value for name in names if isinstance(value := counts.get(name), int)), None)


@dataclass(frozen=True)
class WireFormat:
    """Format of one kind of question and of its answer.

    Args:
        path: below the base URL; ``{model}`` stands for the model's id.
        body: makes the JSON body of the model's id and the question, or the fields of a form with files.
        content: reads an answer; a failed lookup in it becomes an :class:`EndpointFailed`.
        files: makes the files of a form; none for JSON.
        usage: where the answer counts tokens.
        rounds: how often an answer without a picture is asked for again, with the first time, unless it is a refusal.
    """

    path: str
    body: Callable[[str, Question], dict[str, Any]]
    content: Callable[[dict[str, Any]], Content]
    files: Callable[[Question], Sequence[FilePart]] = lambda _: ()
    usage: Usage = Usage()
    rounds: int = 1


class Client:
    """Implements :class:`vcage.models.exchange.Answerer`: one model behind an endpoint.

    Args:
        transport: to the endpoint.
        model: id of the model, as the endpoint spells it.
        provider: name in records: ``openai:gpt-6.1-terra``.
        wire: how it takes questions.
        lists: paths at which the endpoint lists its models.
    """

    def __init__(self, transport: Transport, model: str, provider: str, wire: WireFormat, lists: Sequence[str] = ()):
        self.transport = transport
        self.model = model
        self.provider = provider
        self._wire, self._lists = wire, lists

    def answer(self, question: Question) -> Reply:
        """The answer; a picture comes in the size that the model chooses.

        Raises:
            ModelRefused: a refusal, a truncated answer, or no picture.
            ModelNotServed: the endpoint has no such model; names the served ones.
            EndpointFailed: the answer has an unknown shape, or its picture cannot be decoded; see the transport.
        """
        content = Content()
        for _ in range(self._wire.rounds):
            data = self._post(question)
            content = self._content(data)
            if question.schema is None and content.picture:
                return self._wire.usage.reply(data, picture=decode_base64(content.picture, self.provider))
            if question.schema is not None and content.text and content.whole:
                return self._wire.usage.reply(data, content.text)
            if not content.whole:
                break
        what, other = "gave no whole answer", "another model"
        if question.schema is None:
            what, other = "drew no picture", "--editor offline"
        raise ModelRefused(
            f"{self.provider} {what}: {content.ended or 'no reason given'}",
            hint=f"change the instruction, or use {other}",
            details={"finish_reason": content.ended},
        )

    def _post(self, question: Question) -> dict[str, Any]:
        path, body = self._wire.path.format(model=self.model), self._wire.body(self.model, question)
        try:
            return self.transport.post(path, body, self._wire.files(question))
        except ConfigurationError as error:
            if error.details.get("status") in (400, 404) and (reason := self.not_served()):
                raise reason from error
            raise

    def _content(self, data: dict[str, Any]) -> Content:
        try:
            return self._wire.content(data)
        except (AttributeError, IndexError, KeyError, TypeError) as error:
            raise EndpointFailed(
                f"{self.provider} answered in an unknown shape", hint="check the base URL, or run it again"
            ) from error

    def not_served(self) -> ModelNotServed | None:
        """The error for a model missing in the endpoint's list; None if it is listed, or there is no list."""
        return not_served(self.provider, self.model, self.transport, self._lists)


@dataclass(frozen=True)
class Provider:
    """An endpoint, its key, and its wire formats.

    Args:
        name: as ``--models`` spells it.
        key_variables: environment variables from which its own tools read the key.
        headers: the headers that carry a key.
        base_url, text_model, image_model: used unless :attr:`url_variable`, ``VCAGE_<NAME>_TEXT_MODEL`` and
            ``…_IMAGE_MODEL`` name others.
        text: how it is asked in words and pictures for JSON.
        picture: how it is asked for a picture; None if it draws none.
        version: path of the API, appended to a base URL that has none.
        lists: paths of its lists of models.
        reports_cost: True if its replies state their cost.
        needs_key: False for a free server of the user's own.
        client: what talks to it.
    """

    name: str
    key_variables: tuple[str, ...]
    headers: Callable[[str], dict[str, str]]
    base_url: str
    text_model: str
    text: WireFormat
    image_model: str = ""
    picture: WireFormat | None = None
    version: str = ""
    lists: tuple[str, ...] = ("models",)
    reports_cost: bool = False
    needs_key: bool = True
    client: type[Client] = Client

    def connect(self, key: str, *, picture: bool = False) -> Client:
        """The client for text, or for pictures; nothing is sent yet.

        Raises:
            ConfigurationError: the base URL that was set cannot be used.
        """
        wire, model = (self.picture, self.models[-1]) if picture else (self.text, self.models[0])
        assert wire is not None, self.name
        return self.client(self.transport(key), model, f"{self.name}:{model}", wire, self.lists)

    @property
    def models(self) -> list[str]:
        """The ids of the model for text, and of the one for pictures if there is one."""
        text = self._setting("TEXT_MODEL", self.text_model)
        return [text] if self.picture is None else [text, self._setting("IMAGE_MODEL", self.image_model)]

    def served(self, key: str) -> Served:
        """The models that the endpoint lists; raises as :meth:`vcage.models.served.Served.at`."""
        return Served.at(self.transport(key, QUICK), self.lists)

    def blind(self) -> str:
        """The sentence that its model takes no pictures; empty if it does."""
        return ""

    def transport(self, key: str, limits: TransportLimits | None = None) -> Transport:
        """The transport to the endpoint.

        Raises:
            ConfigurationError: the base URL that was set cannot be used.
        """
        return Transport(self.url, self.headers(key), limits=limits or TransportLimits())

    @property
    def url_variable(self) -> str:
        """The environment variable for another base URL."""
        return f"VCAGE_{self.name.upper()}_BASE_URL"

    @property
    def model_variable(self) -> str:
        """The environment variable for another model for text."""
        return f"VCAGE_{self.name.upper()}_TEXT_MODEL"

    @property
    def url(self) -> str:
        """The base URL, with the API's version.

        Raises:
            ConfigurationError: the configured one contains text that errors must not show.
        """
        url = (os.environ.get(self.url_variable) or self.base_url).rstrip("/")
        secret = "a user or password" if "@" in url.partition("://")[2].partition("/")[0] else ""
        secret = secret or ("a query or a fragment" if "?" in url or "#" in url else "")
        if secret:
            raise ConfigurationError(
                f"{self.url_variable} holds {secret}, which errors would show",
                hint="give only scheme, host and path; set the key separately",
            )
        needs_version = self.version and not url.endswith(("/v1", "/v1beta"))
        return f"{url}/{self.version}" if needs_version else url

    def _setting(self, what: str, default: str) -> str:
        return os.environ.get(f"VCAGE_{self.name.upper()}_{what}") or default


def bearer(key: str) -> dict[str, str]:
    """The header of RFC 6750, which most endpoints take."""
    return {"Authorization": f"Bearer {key}"}
