"""Which implementation plays which role, by one word: ``--models auto|offline|gemini|openai|openrouter``."""

from __future__ import annotations

import os
from collections.abc import Callable

from vcage.errors import UnknownName
from vcage.models.keys import found_keys, require_key
from vcage.models.protocols import Models

ONLINE = ("gemini", "openai", "openrouter")
"""Online choices, in the order in which ``auto`` takes the first one that has a key."""

CHOICES = ("auto", "offline", *ONLINE)


def build_models(choice: str = "auto") -> Models:
    """All roles for a choice; detector and embedder are the offline ones in every choice.

    Base URLs and model ids come from ``VCAGE_<PROVIDER>_BASE_URL``, ``…_TEXT_MODEL`` and ``…_IMAGE_MODEL``
    where these are set.

    Raises:
        UnknownName: there is no such choice.
        MissingKey: the provider's key is nowhere to be found.
    """
    if choice not in CHOICES:
        raise UnknownName("choice of models", choice, CHOICES)
    if choice == "auto":
        keys = found_keys()
        choice = next((provider for provider in ONLINE if provider in keys), "offline")
    builders: dict[str, Callable[[], Models]] = {"offline": _offline, "gemini": _gemini}
    return builders[choice]() if choice in builders else _openai(choice)


def _setting(provider: str, what: str, default: str) -> str:
    return os.environ.get(f"VCAGE_{provider.upper()}_{what}") or default


def _offline() -> Models:
    from vcage.models.offline.critic import OfflineCritic
    from vcage.models.offline.detector import BackgroundDetector
    from vcage.models.offline.editor import OfflineEditor
    from vcage.models.offline.embedder import ClassicalEmbedder
    from vcage.models.offline.reasoner import OfflineReasoner

    return Models(OfflineReasoner(), OfflineEditor(), BackgroundDetector(), ClassicalEmbedder(), OfflineCritic())


def _gemini() -> Models:
    from vcage.models.gemini import BASE_URL, IMAGE_MODEL, TEXT_MODEL, GeminiChat, GeminiEditor
    from vcage.models.llm import LlmReasoner
    from vcage.models.llm_critic import LlmCritic
    from vcage.models.transport import Transport

    headers = {"x-goog-api-key": require_key("gemini")}
    transport = Transport(_setting("gemini", "BASE_URL", BASE_URL), headers)
    chat = GeminiChat(transport, _setting("gemini", "TEXT_MODEL", TEXT_MODEL))
    editor = GeminiEditor(transport, _setting("gemini", "IMAGE_MODEL", IMAGE_MODEL))
    local = _offline()
    return Models(LlmReasoner(chat), editor, local.detector, local.embedder, LlmCritic(chat))


def _openai(provider: str) -> Models:
    from vcage.models.llm import LlmReasoner
    from vcage.models.llm_critic import LlmCritic
    from vcage.models.openai import BASE_URLS, IMAGE_MODELS, TEXT_MODELS, OpenAiChat, OpenAiEditor, OpenRouterEditor
    from vcage.models.transport import Transport

    headers = {"Authorization": f"Bearer {require_key(provider)}"}
    transport = Transport(_setting(provider, "BASE_URL", BASE_URLS[provider]), headers)
    chat = OpenAiChat(transport, _setting(provider, "TEXT_MODEL", TEXT_MODELS[provider]), provider)
    editor_type = OpenAiEditor if provider == "openai" else OpenRouterEditor
    editor = editor_type(transport, _setting(provider, "IMAGE_MODEL", IMAGE_MODELS[provider]), provider)
    local = _offline()
    return Models(LlmReasoner(chat), editor, local.detector, local.embedder, LlmCritic(chat))
