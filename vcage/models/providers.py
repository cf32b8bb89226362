"""All providers, those with a key, and the choice of ``auto`` among them."""

from __future__ import annotations

from collections.abc import Mapping

from vcage.models.anthropic import ANTHROPIC
from vcage.models.gemini import GEMINI
from vcage.models.keys import find_key, variables
from vcage.models.ollama import OLLAMA
from vcage.models.openai import OPENAI
from vcage.models.openrouter import OPENROUTER
from vcage.models.protocols import OFFLINE
from vcage.models.provider import Provider

PROVIDERS: dict[str, Provider] = {
    provider.name: provider for provider in (GEMINI, OPENAI, OPENROUTER, ANTHROPIC, OLLAMA)
}
"""Choices behind an endpoint; ``auto`` takes the first one that has a key."""


def found_keys() -> dict[str, str]:
    """Return the source of each key, a variable or file, by provider; never the key itself.

    Raises:
        ConfigurationError: the key file cannot be read.
    """
    keyed = [provider for provider in PROVIDERS.values() if provider.needs_key]
    return {provider.name: found[1] for provider in keyed if (found := find_key(provider)) is not None}


def automatic_choice() -> str:
    """The choice of ``auto``."""
    return next(iter(found_keys()), OLLAMA.name if OLLAMA.is_there() else OFFLINE)


def explain_automatic(chosen: Mapping[str, str]) -> str:
    """The sentence about the choice of ``auto``.

    Args:
        chosen: by role, the resolved provider.
    """
    taken = automatic_choice()
    online = [role for role, who in chosen.items() if who != OFFLINE]
    offline = [role for role, who in chosen.items() if who == OFFLINE]
    parts = [f"{taken} for {', '.join(online)}"] if online else []
    parts += [f"rules (offline) for {', '.join(offline)}"] if offline else []
    return f"{', '.join(parts)}, {_reason(taken)}{'; --models names another' if online else ''}"


def _reason(taken: str) -> str:
    """The reason for the choice of ``auto``."""
    found = found_keys()
    if taken in found:
        others = f"; {' and '.join(rest)} too" if (rest := [other for other in found if other != taken]) else ""
        return f"since its key is in {found[taken]}{others}"
    if taken == OLLAMA.name:
        return f"since no provider has a key and it answers at {OLLAMA.url} with {OLLAMA.found().model}"
    names = ", ".join(variables(provider)[0] for provider in PROVIDERS.values() if provider.needs_key)
    return f"since there is no key of a provider in {names}, and no Ollama at {OLLAMA.url}"
