"""What is particular to a provider of models online; one file each says it (``gemini``, ``openai``…)."""

from __future__ import annotations

import os
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from vcage.base.errors import ConfigurationError, ModelNotServed, ModelRefused
from vcage.models.exchange import Question, Reply
from vcage.models.served import Served, not_served
from vcage.models.transport import FilePart, Transport


class Client(ABC):
    """Implements :class:`vcage.models.exchange.Answerer`: one model behind an endpoint.

    Args:
        model: its id, as the endpoint spells it.
        provider: what records call it: ``openai:gpt-6.1-terra``.
        lists: paths at which the endpoint says what it serves.
    """

    def __init__(self, transport: Transport, model: str, provider: str, lists: Sequence[str] = ()):
        self.transport = transport
        self.model = model
        self.provider = provider
        self._lists = lists

    @abstractmethod
    def answer(self, question: Question) -> Reply:
        """See :class:`vcage.models.exchange.Answerer`."""

    def post(self, path: str, body: Mapping[str, Any], files: Sequence[FilePart] = ()) -> dict[str, Any]:
        """The JSON object that answers a JSON body, or a form with files; raises as the transport.

        Raises:
            ModelNotServed: the endpoint answers that there is no such model; names those that it serves.
        """
        try:
            if files:
                return self.transport.post_multipart(path, body, files)
            return self.transport.post_json(path, body)
        except ConfigurationError as error:
            if error.details.get("status") in (400, 404) and (reason := self.not_served()):
                raise reason from error
            raise

    def cut_off(self, reason: str) -> ModelRefused:
        """The error about an answer that is none, or not whole.

        Args:
            reason: as the endpoint says it.
        """
        return ModelRefused(
            f"{self.provider} gave no whole answer: {reason or 'no text'}",
            hint="change the instruction or the model",
            details={"finish_reason": reason},
        )

    def not_served(self) -> ModelNotServed | None:
        """The error about the model where the endpoint says what it serves, and this is not among it."""
        return not_served(self.provider, self.model, self.transport, self._lists)


MadeBy = Callable[[Transport, str, str, Sequence[str]], Client]

QUICK = (5.0, 10.0)
"""Seconds to connect and to wait, where only a look is taken at what is served."""


@dataclass(frozen=True)
class Provider:
    """An endpoint, how it takes a key, and the clients that speak its language.

    Args:
        name: as ``--models`` spells it.
        key_variables: environment variables that its own tools read the key from.
        headers: what carries a key in a request.
        base_url, text_model, image_model: where :attr:`url_variable`, ``VCAGE_<NAME>_TEXT_MODEL`` and
            ``…_IMAGE_MODEL`` do not name others.
        version: path of the API, for a base URL that ends with none.
        lists: paths at which it says what it serves.
        tells_cost: its replies say what they cost.
        needs_key: it is no server of the user's own, which takes none and costs nothing.
        text, picture: made from transport, model, the name for records, and the lists; None where it draws no pictures.
    """

    name: str
    key_variables: tuple[str, ...]
    headers: Callable[[str], dict[str, str]]
    base_url: str
    text_model: str
    image_model: str
    lists: tuple[str, ...]
    text: MadeBy
    picture: MadeBy | None
    version: str = ""
    tells_cost: bool = False
    needs_key: bool = True

    def connect(self, key: str, *, picture: bool = False) -> Client:
        """What answers in text, or in pictures; nothing is sent yet.

        Raises:
            ConfigurationError: the base URL that was set is none.
        """
        make, model = (self.picture, self.models[-1]) if picture else (self.text, self.models[0])
        assert make is not None, self.name
        return make(self.transport(key), model, f"{self.name}:{model}", self.lists)

    @property
    def models(self) -> list[str]:
        """The ids of the model that answers in text, and of the one that draws if there is one."""
        text = self._setting("TEXT_MODEL", self.text_model)
        return [text] if self.picture is None else [text, self._setting("IMAGE_MODEL", self.image_model)]

    def served(self, key: str) -> Served:
        """What the endpoint serves; raises as :meth:`vcage.models.served.Served.at`."""
        return Served.at(self.transport(key, timeout=QUICK), self.lists)

    def blind(self) -> str:
        """Say that its model sees no pictures; empty where it does."""
        return ""

    def transport(self, key: str, **options: Any) -> Transport:
        """The transport to the endpoint; options as :class:`vcage.models.transport.Transport` takes them.

        Raises:
            ConfigurationError: the base URL that was set is none.
        """
        return Transport(self.url, self.headers(key), **options)

    @property
    def url_variable(self) -> str:
        """The environment variable that names another base URL."""
        return f"VCAGE_{self.name.upper()}_BASE_URL"

    @property
    def model_variable(self) -> str:
        """The environment variable that names another model for answers in text."""
        return f"VCAGE_{self.name.upper()}_TEXT_MODEL"

    @property
    def url(self) -> str:
        """The base URL, with the API's version.

        Raises:
            ConfigurationError: the one that was set holds what errors must not show.
        """
        url = (os.environ.get(self.url_variable) or self.base_url).rstrip("/")
        if "@" in url.partition("://")[2].partition("/")[0]:
            raise ConfigurationError(
                f"{self.url_variable} holds a user or password, which errors would show",
                hint="leave it out; a key has a place of its own",
            )
        if "?" in url or "#" in url:
            raise ConfigurationError(
                f"{self.url_variable} holds a query or a fragment, which errors would show",
                hint="give scheme, host and path alone; a key has a place of its own",
            )
        if self.version and not url.endswith(("/v1", "/v1beta")):
            url = f"{url}/{self.version}"
        return url

    def _setting(self, what: str, default: str) -> str:
        return os.environ.get(f"VCAGE_{self.name.upper()}_{what}") or default


def count(used: Mapping[str, object], name: str) -> int | None:
    """A number of tokens in an answer; None where it says none."""
    value = used.get(name)
    return value if isinstance(value, int) else None


def bearer(key: str) -> dict[str, str]:
    """The header of RFC 6750, which most endpoints take."""
    return {"Authorization": f"Bearer {key}"}
