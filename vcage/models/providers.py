"""The providers that there are, and which of them have a key."""

from __future__ import annotations

from vcage.models.anthropic import ANTHROPIC
from vcage.models.gemini import GEMINI
from vcage.models.keys import find_key
from vcage.models.ollama import OLLAMA
from vcage.models.openai import OPENAI
from vcage.models.openrouter import OPENROUTER
from vcage.models.provider import Provider

PROVIDERS: dict[str, Provider] = {
    provider.name: provider for provider in (GEMINI, OPENAI, OPENROUTER, ANTHROPIC, OLLAMA)
}
"""Choices that are asked over HTTP, in the order in which ``auto`` takes the first one that has a key."""


def found_keys() -> dict[str, str]:
    """Provider → the name of the variable or file that holds its key, for those that have one; never the key.

    Raises:
        ConfigurationError: the key file cannot be read.
    """
    asked = [provider for provider in PROVIDERS.values() if provider.needs_key]
    return {provider.name: found[1] for provider in asked if (found := find_key(provider)) is not None}
