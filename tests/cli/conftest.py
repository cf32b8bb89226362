from __future__ import annotations

from pathlib import Path

import pytest


@pytest.fixture
def data(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where a user's own objects and robots lie, empty."""
    monkeypatch.setenv("VCAGE_DATA", str(tmp_path / "data"))
    return tmp_path / "data"
