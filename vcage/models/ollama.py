"""Ollama, and other servers on the user's own machine: OpenAI's chat without a key and without a price.

Wire formats: https://docs.ollama.com/openai, …/api-reference/show-model-details, …/api-reference/list-running-models
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

from vcage.base.errors import ConfigurationError, EndpointFailed, VcageError
from vcage.models.exchange import Question, Reply
from vcage.models.openai import CHAT
from vcage.models.provider import Client, Provider
from vcage.models.served import Served
from vcage.models.transport import Transport, TransportLimits

PROBE = TransportLimits(connect_s=0.5, read_s=3.0)
"""Limits where only the presence of a server is tested."""

PATIENT = TransportLimits(connect_s=2.0, read_s=1800.0, total_s=1800.0)
"""A laptop without a GPU takes minutes to read a long prompt, and sends nothing meanwhile."""

CHARACTERS_PER_TOKEN = 4.0
"""Characters of a prompt in the fewest tokens that they can be; names and numbers take more tokens."""


class LocalClient(Client):
    """A client for a server that may silently cut off the end of a long prompt; that is an error here."""

    def answer(self, question: Question) -> Reply:
        """See :class:`vcage.models.exchange.Answerer`.

        Raises:
            ConfigurationError: the question is longer than the model's context, which Ollama does not report.
        """
        reply = super().answer(question)
        characters = sum(len(message.text) for message in question.messages)
        context = _context(_beside(self.transport), self.model)
        if context is not None and characters > CHARACTERS_PER_TOKEN * context:
            raise ConfigurationError(
                f"{self.provider} has a context of {context:,} tokens, and {question.name} has {characters:,}"
                " characters: it did not read all of them",
                hint=f"start Ollama with a longer one: OLLAMA_CONTEXT_LENGTH={_enough(characters)} ollama serve",
                details={"context": context, "characters": characters},
            )
        return reply


@dataclass(frozen=True)
class Local(Provider):
    """A provider on the user's own machine; the first model that it lists answers unless one is named."""

    @property
    def url_variable(self) -> str:
        """See :attr:`vcage.models.provider.Provider.url_variable`."""
        return f"VCAGE_{self.name.upper()}_URL"

    @property
    def models(self) -> list[str]:
        """The model that answers in text.

        Raises:
            EndpointFailed: the server does not answer.
            ConfigurationError: it has no model.
        """
        named = self._setting("TEXT_MODEL", self.text_model)
        return [named] if named else [self.found().model]

    def found(self) -> Found:
        """The server's models, asked once in a process.

        Raises:
            EndpointFailed: the server does not answer.
            ConfigurationError: it has no model, or the URL that was set is none.
        """
        found = _look(self, self.url, self._setting("TEXT_MODEL", self.text_model))
        if isinstance(found, VcageError):
            raise found
        return found

    def is_there(self) -> bool:
        """Check if the server answers, and has a model."""
        try:
            self.found()
        except VcageError:
            return False
        return True

    def blind(self) -> str:
        """See :meth:`vcage.models.provider.Provider.blind`."""
        try:
            found = self.found()
        except VcageError:
            return ""  # the error comes when it is asked
        return "" if found.sees else f"{self.name}:{found.model} sees no pictures"

    def transport(self, key: str, limits: TransportLimits | None = None) -> Transport:
        """See :meth:`vcage.models.provider.Provider.transport`."""
        return super().transport(key, limits or PATIENT)


@dataclass(frozen=True)
class Found:
    """Models of a server.

    Args:
        served: the models in its list.
        model: the answering one.
        sees: True if that model takes pictures, or if the server does not say.
    """

    served: Served
    model: str
    sees: bool


@cache
def _look(provider: Local, url: str, named: str) -> Found | VcageError:
    """The models of a server, or the error that came instead."""
    transport = provider.transport("", PROBE)
    try:
        served = Served.at(transport, provider.lists)
    except EndpointFailed as error:
        error.hint = f"start it with: ollama serve, or name its address in {provider.url_variable}"
        return error
    except VcageError as error:
        return error
    for model in [named] if named else served.models:
        abilities = _abilities(transport, model, served)
        if named or "completion" in abilities:  # others make vectors
            return Found(served, model, "vision" in abilities)
    return ConfigurationError(
        f"{provider.name} at {url} has no model for answers in text",
        hint="fetch one with vision, too: ollama pull qwen3-vl:8b",
        details={"models": sorted(served.models)},
    )


def _abilities(transport: Transport, model: str, served: Served) -> frozenset[str]:
    """The abilities of a model as the server reports them; all if it does not."""
    if model in served.modalities:  # llama.cpp's server says so in its list
        return frozenset({"completion", *(["vision"] if "image" in served.modalities[model] else [])})
    try:
        said = _beside(transport).post("api/show", {"model": model}).get("capabilities")
    except VcageError:
        said = None
    return frozenset(said) if isinstance(said, list) else frozenset({"completion", "vision"})


def _context(transport: Transport, model: str) -> int | None:
    """The context of a loaded model in tokens; None if the server does not report it."""
    try:
        running = transport.get_json("api/ps").get("models")
    except VcageError:
        return None
    sizes = {item.get("name"): item.get("context_length") for item in running or () if isinstance(item, dict)}
    size = sizes.get(model, sizes.get(f"{model}:latest"))
    return size if isinstance(size, int) and size > 0 else None


def _beside(transport: Transport) -> Transport:
    """The server's own interface, which lies beside OpenAI's."""
    return transport.at(transport.base_url.removesuffix("/v1"))


def _enough(characters: int) -> int:
    """A context that holds a prompt and its answer: a power of two."""
    return 1 << (characters // 2).bit_length()


OLLAMA = Local(
    name="ollama",
    key_variables=(),
    headers=lambda _: {},
    base_url="http://127.0.0.1:11434",
    text_model="",
    text=CHAT,
    version="v1",
    needs_key=False,
    client=LocalClient,
)
