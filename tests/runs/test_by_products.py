"""By-products of a run are read as far as they can be."""

from __future__ import annotations

from pathlib import Path

import pytest

from vcage.base.files import write_json
from vcage.runs.by_products import read_by_product


@pytest.mark.parametrize("content", [None, b"{", b"[]", b"\xff"])
def test_a_file_that_cannot_be_read_holds_nothing(tmp_path: Path, content: bytes | None):
    path = tmp_path / "timings.json"
    if content is not None:
        path.write_bytes(content)
    assert read_by_product(path, float) == {}


def test_entries_of_another_kind_are_left_out(tmp_path: Path):
    path = write_json(tmp_path / "timings.json", {"match": 1.5, "collect": "long", "verify": True, "export": 2})
    assert read_by_product(path, float) == {"match": 1.5, "export": 2.0}
    path = write_json(tmp_path / "options.json", {"seed": ["--seed", "1"], "script": "x.py", "fps": [5]})
    assert read_by_product(path, list[str]) == {"seed": ["--seed", "1"]}
