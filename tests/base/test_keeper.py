from __future__ import annotations

from pathlib import Path
from typing import ClassVar

import pytest

from vcage.base.errors import DamagedFile, MissingStage, SchemaMismatch
from vcage.base.keeper import Keeper
from vcage.schema.base import Document


class Bread(Document):
    SCHEMA: ClassVar[str] = "vcage.bread/1"

    made_from: str
    grams: int


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return Bread(made_from="rye", grams=700).write(tmp_path / "bread.json")


def test_work_made_from_the_same_is_kept(path):
    assert Keeper(path, Bread, "rye").kept() == Bread(made_from="rye", grams=700)


def test_work_made_from_another_is_to_be_done_again(path):
    keeper = Keeper(path, Bread, "wheat")
    assert keeper.kept() is None
    assert not keeper.knows(keeper.found())


def test_a_stage_never_run_is_missing(tmp_path):
    keeper = Keeper(tmp_path / "bread.json", Bread, "rye")
    assert keeper.kept() is None
    with pytest.raises(MissingStage):
        keeper.found()


@pytest.mark.parametrize(("text", "error"), [("{", DamagedFile), ('{"schema": "vcage.cake/1"}', SchemaMismatch)])
def test_a_damaged_record_counts_for_nothing_and_names_its_fault_when_asked(path, text, error):
    path.write_text(text)
    keeper = Keeper(path, Bread, "rye")
    assert keeper.kept() is None
    with pytest.raises(error, match=path.name):
        keeper.found()
