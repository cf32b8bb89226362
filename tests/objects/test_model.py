"""Errors in a model's description name the field: that of an imported object is the user's file."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import trimesh

from vcage.base.errors import DamagedFile, MissingStage, SchemaMismatch
from vcage.objects.model import DESCRIPTION, read_model, write_model
from vcage.objects.modelling.mappings import tiled
from vcage.objects.modelling.parts import BuiltObject, MovingPart, paint
from vcage.schema.asset import Joint


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A box with a drawer, as it is written."""
    box = trimesh.creation.box([0.1, 0.1, 0.1])
    part = paint(box, np.full((4, 4, 3), 150, dtype=np.uint8), tiled(0.1))
    joint = Joint(kind="slide", origin=(0, 0, 0), axis=(0, -1, 0), lower=0, upper=0.1, damping=8, friction=3)
    write_model(BuiltObject([part], [box], 1.0, moving=[MovingPart("drawer", [part], [box], 0.2, joint)]), tmp_path)
    return tmp_path


def change(folder: Path, **fields: object) -> None:
    """Change fields of the description; None takes one out."""
    data = {**json.loads((folder / DESCRIPTION).read_text()), **fields}
    (folder / DESCRIPTION).write_text(json.dumps({name: value for name, value in data.items() if value is not None}))


def test_a_written_record_is_read(folder):
    model = read_model(folder)
    assert (model.mass, model.lower, model.upper) == (1.0, (-0.05, -0.05, 0.0), (0.05, 0.05, 0.1))
    assert [(link.name, link.mass, len(link.hulls)) for link in model.links] == [("drawer", 0.2, 1)]
    assert all(Path(path).is_file() for path in (model.visual, *model.hulls, model.links[0].visual))


@pytest.mark.parametrize("field", ["hulls", "lower", "upper", "mass", "friction", "links"])
def test_a_missing_field_is_named(folder, field):
    change(folder, **{field: None})
    with pytest.raises(SchemaMismatch, match=rf"model.json: field {field}: Field required$") as caught:
        read_model(folder)
    assert caught.value.details["field"] == field


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"mass": -1}, r"field mass: .*greater than 0; got -1"),
        ({"hulls": "many"}, r"field hulls: .*got 'many'"),
        ({"hulls": 0}, r"field hulls: .*greater than or equal to 1; got 0"),
        ({"lower": [0, 0]}, r"field lower.2: Field required"),
        ({"links": [{"name": "drawer"}]}, r"field links.0.hulls: Field required"),
    ],
)
def test_a_wrong_field_is_named(folder, fields, message):
    change(folder, **fields)
    with pytest.raises(SchemaMismatch, match=message):
        read_model(folder)


def test_a_part_that_occurs_twice_is_named(folder):
    (link,) = json.loads((folder / DESCRIPTION).read_text())["links"]
    change(folder, links=[link, link])
    with pytest.raises(SchemaMismatch, match=r"model.json: field \(whole file\): .*link 'drawer': expected a new name"):
        read_model(folder)


@pytest.mark.parametrize("text", ["[]", "5"])
def test_a_description_other_than_an_object_is_named(folder, text):
    (folder / DESCRIPTION).write_text(text)
    with pytest.raises(SchemaMismatch, match=r"model.json: field \(whole file\)"):
        read_model(folder)


def test_a_missing_or_invalid_description_is_named(folder):
    (folder / DESCRIPTION).write_text("{")
    with pytest.raises(DamagedFile, match=DESCRIPTION):
        read_model(folder)
    (folder / DESCRIPTION).unlink()
    with pytest.raises(MissingStage, match=DESCRIPTION):
        read_model(folder)
