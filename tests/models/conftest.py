"""Fixtures shared by the tests of models."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.model_server import ModelServer
from vcage.models.keys import variables
from vcage.models.providers import PROVIDERS


@pytest.fixture
def server() -> Iterator[ModelServer]:
    with ModelServer() as running:
        yield running


@pytest.fixture(autouse=True)
def no_keys(monkeypatch: pytest.MonkeyPatch, tmp_path_factory: pytest.TempPathFactory) -> None:
    """No key and no setting of the machine reaches a test."""
    for provider in PROVIDERS.values():
        for name in variables(provider):
            monkeypatch.delenv(name, raising=False)
        for what in ("BASE_URL", "TEXT_MODEL", "IMAGE_MODEL"):
            monkeypatch.delenv(f"VCAGE_{provider.name.upper()}_{what}", raising=False)
    monkeypatch.setenv("VCAGE_KEY_FILE", str(tmp_path_factory.mktemp("keys") / "keys.json"))
