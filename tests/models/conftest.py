"""Fixtures shared by the tests of models."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.model_server import ModelServer
from vcage.models import ollama
from vcage.models.keys import variables
from vcage.models.providers import PROVIDERS


@pytest.fixture
def server() -> Iterator[ModelServer]:
    with ModelServer() as running:
        yield running


@pytest.fixture(autouse=True)
def no_keys(monkeypatch: pytest.MonkeyPatch, tmp_path_factory: pytest.TempPathFactory) -> None:
    """No key and no setting of the machine reaches a test, and no test what another found."""
    ollama._look.cache_clear()
    for provider in PROVIDERS.values():
        for name in variables(provider):
            monkeypatch.delenv(name, raising=False)
        if provider.needs_key:
            monkeypatch.delenv(provider.url_variable, raising=False)
        for what in ("TEXT_MODEL", "IMAGE_MODEL"):
            monkeypatch.delenv(f"VCAGE_{provider.name.upper()}_{what}", raising=False)
    monkeypatch.setenv("VCAGE_KEY_FILE", str(tmp_path_factory.mktemp("keys") / "keys.json"))
