"""Pictures of surfaces: same name, same bytes; painted once."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from vcage.base.errors import UnknownName
from vcage.objects import surface_pictures
from vcage.objects.surface_pictures import SURFACES, surface_picture
from vcage.schema.randomisation import Where


@pytest.fixture
def painted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The names of the painted textures, in a cache of their own."""
    names: list[str] = []

    def noted(name, paint):
        return lambda rng: names.append(name) or paint(rng)

    monkeypatch.setenv("VCAGE_CACHE", str(tmp_path))
    tables = {name: noted(name, paint) for name, paint in SURFACES["table"].items()}
    monkeypatch.setattr(surface_pictures, "SURFACES", {"table": tables})
    return names


@pytest.mark.slow
@pytest.mark.parametrize(("where", "name"), [(where, name) for where in SURFACES for name in SURFACES[where]])
def test_a_surface_is_a_picture_and_always_the_same(where: Where, name: str) -> None:
    first = surface_picture(where, name)
    assert first.dtype == np.uint8 and first.ndim == 3 and first.shape[2] == 3
    assert first.std() > 0.5
    np.testing.assert_array_equal(first, SURFACES[where][name](np.random.default_rng(len(name))))


def test_another_process_finds_it_painted(painted: list[str]) -> None:
    first = surface_picture.__wrapped__("table", "white_laminate")
    np.testing.assert_array_equal(first, surface_picture.__wrapped__("table", "white_laminate"))
    assert painted == ["white_laminate"]


def test_a_table_texture_is_read_only() -> None:
    with pytest.raises(ValueError, match="read-only"):
        surface_picture("table", "oak")[:] = 0


def test_an_unknown_table_top_is_refused_with_the_known_ones() -> None:
    with pytest.raises(UnknownName, match="grey_stone, marble, oak"):
        surface_picture("table", "jade")
