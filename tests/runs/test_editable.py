"""Fields of a stage's JSON that may be edited."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from tests.run_folders import Finished, copied
from vcage.base.errors import InputFileError
from vcage.base.files import read_json, write_json
from vcage.runs.edits import Editable, changes
from vcage.schema.plan import Plan


@pytest.fixture
def plan(finished: Finished, tmp_path: Path) -> Path:
    """A plan of which the text, and the number of relations, were edited."""
    path = copied(finished.run, tmp_path / "run").plan
    data: dict[str, Any] = read_json(path)
    data["text"] = "Otherwise."
    data["relations"].append({**data["relations"][0], "subject": "a_new_thing"})
    write_json(path, data)
    return path


def accepted(plan: Path, finished: Finished, *fields: str) -> Plan:
    return Editable(Plan, fields).accepted(finished.run, plan, [plan.name], plan.parent, finished.context)


def test_a_longer_list_is_one_change_of_its_length(plan):
    assert [place for place, _, _ in changes(plan)] == [("text",), ("relations", "#")]


def test_an_edit_of_fields_that_may_be_edited_is_used_and_named(plan, finished):
    record = accepted(plan, finished, "text", "relations.#")
    assert (record.text, record.edited) == ("Otherwise.", ["plan.json"])


@pytest.mark.parametrize(
    ("fields", "complaint"), [(["text"], "field relations: "), (["relations"], 'field text: "Otherwise."; expected')]
)
def test_an_edit_of_another_field_is_refused_with_the_old_value(plan, finished, fields, complaint):
    with pytest.raises(InputFileError, match=complaint):
        accepted(plan, finished, *fields)
