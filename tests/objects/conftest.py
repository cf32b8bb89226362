"""Fixtures: the library, and every variant as a pair of names."""

from __future__ import annotations

import pytest

from vcage.objects.library import Library

LIBRARY = Library.load()
VARIANTS = [(name, v.id) for name in LIBRARY.names for v in LIBRARY.annotation(name).variants]


@pytest.fixture(scope="session")
def library() -> Library:
    return LIBRARY


@pytest.fixture(params=VARIANTS, ids="/".join)
def asset(request: pytest.FixtureRequest, library: Library):
    return library.asset(*request.param)


@pytest.fixture(params=LIBRARY.names)
def first_variant(request: pytest.FixtureRequest, library: Library):
    return library.asset(request.param)
