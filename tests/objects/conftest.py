"""Fixtures: the library, and its models, each loaded once."""

from __future__ import annotations

import pytest

from vcage.objects.asset import Asset
from vcage.objects.library import Library


@pytest.fixture(scope="session")
def library() -> Library:
    return Library.load()


@pytest.fixture(scope="session")
def variants(library: Library) -> list[Asset]:
    """Every variant of every kind."""
    return [library.asset(*names) for names in library.variants()]


@pytest.fixture(scope="session")
def kinds(library: Library) -> list[Asset]:
    """The first variant of every kind."""
    return [library.asset(name) for name in library.names]
