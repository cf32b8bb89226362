"""Table tops: same name, same bytes; painted once."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from vcage.base.errors import UnknownName
from vcage.objects import table_tops
from vcage.objects.table_tops import TABLES, table_texture


@pytest.fixture
def painted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The names of what is painted, in a cache of its own."""
    names: list[str] = []

    def noted(name, paint):
        return lambda rng: names.append(name) or paint(rng)

    monkeypatch.setenv("VCAGE_CACHE", str(tmp_path))
    monkeypatch.setattr(table_tops, "TABLES", {name: noted(name, paint) for name, paint in TABLES.items()})
    return names


@pytest.mark.parametrize("name", TABLES)
def test_a_table_top_is_a_picture_and_always_the_same(name: str) -> None:
    first = table_texture(name)
    assert first.dtype == np.uint8 and first.ndim == 3 and first.shape[2] == 3
    assert first.std() > 0.5
    np.testing.assert_array_equal(first, TABLES[name](np.random.default_rng(len(name))))


def test_another_process_finds_it_painted(painted: list[str]) -> None:
    first = table_texture.__wrapped__("white_laminate")
    np.testing.assert_array_equal(first, table_texture.__wrapped__("white_laminate"))
    assert painted == ["white_laminate"]


def test_who_changes_it_is_stopped() -> None:
    with pytest.raises(ValueError, match="read-only"):
        table_texture("oak")[:] = 0


def test_an_unknown_table_top_is_refused_with_those_that_exist() -> None:
    with pytest.raises(UnknownName, match="grey_stone, marble, oak"):
        table_texture("jade")
