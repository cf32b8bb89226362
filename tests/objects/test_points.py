"""Misfits of an annotation and its model are found when the model is first built."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from vcage.base.errors import DamagedFile, SchemaMismatch
from vcage.objects.library import Library
from vcage.objects.points import check_meshes, check_points, outside_by
from vcage.schema.asset import Annotation

GRASP = {"id": 0, "name": "x", "position": (0, 0, 0.02), "approach": (0, 0, -1), "closing": (0, 1, 0)}


def _with(asset, **fields):
    annotation = type(asset.annotation).model_validate({**asset.annotation.model_dump(), **fields})
    return type(asset)(annotation, asset.variant, asset.model)


@pytest.fixture
def block(library: Library):
    return library.asset("block")


def test_a_contact_point_outside_the_object_is_named_with_value_and_range(block) -> None:
    asset = _with(block, contact_points=[GRASP, {**GRASP, "id": 1, "position": (0, 0, 0.5)}])
    with pytest.raises(
        SchemaMismatch, match=r"asset.json: field contact_points.1.position: .*0.500.*expected"
    ) as caught:
        check_points(asset, Path("asset.json"))
    assert caught.value.details["field"] == "contact_points.1.position"


def test_a_contact_point_may_lie_a_little_outside(block) -> None:
    check_points(_with(block, contact_points=[{**GRASP, "position": (0, 0, block.size[2] + 0.019)}]), Path("x"))


def test_a_functional_point_under_the_table_is_named(block) -> None:
    point = {"id": 0, "name": "x", "holds": "on", "position": (0, 0, -0.01)}
    with pytest.raises(SchemaMismatch, match=r"functional_points.0.position: the point lies 0.01 m under the table"):
        check_points(_with(block, functional_points=[point]), Path("asset.json"))


def test_a_point_on_a_missing_part_is_named(block) -> None:
    with pytest.raises(SchemaMismatch, match=r"contact_points.0.link: 'lid'; expected none"):
        check_points(_with(block, contact_points=[{**GRASP, "link": "lid"}]), Path("asset.json"))


def test_a_model_without_extent_is_named(block) -> None:
    flat = type(block)(block.annotation, block.variant, block.model.model_copy(update={"upper": (0.02, 0.02, 0.0)}))
    with pytest.raises(SchemaMismatch, match=r"field variants.0: the model measures"):
        check_points(flat, Path("asset.json"))


def test_a_size_of_zero_is_named_before_the_model_is_made(tmp_path: Path) -> None:
    package = {"model": "x", "size": (0.1, 0.1, 0.0), "mass": 0.1}
    data = {
        "schema": "vcage.asset/1",
        "name": "thing",
        "source": "ycb",
        "words": {"name": "thing", "plural": "things", "description": "A thing.", "category": "toy"},
        "variants": [{"id": "red", "colour": "red", "package": package}],
    }
    annotation = Annotation.model_validate(data)
    with pytest.raises(SchemaMismatch, match=r"field variants.0.package.size.2: got 0; expected a length above 0"):
        Library({"thing": annotation}, {"thing": tmp_path}).asset("thing")


@pytest.mark.parametrize("content", [b"", b"glTF", b"glTF\x02\x00\x00\x00\xff\x00\x00\x00", None])
def test_a_mesh_that_does_not_load_is_named(block, tmp_path: Path, content: bytes | None) -> None:
    path = tmp_path / "visual.glb"
    if content is not None:
        path.write_bytes(content)
    broken = type(block)(block.annotation, block.variant, block.model.model_copy(update={"visual": str(path)}))
    with pytest.raises(DamagedFile, match=r"visual\.glb is not a mesh that loads"):
        check_meshes(broken)


def test_a_piece_that_does_not_load_is_named(block, tmp_path: Path) -> None:
    path = tmp_path / "hull-00.obj"
    path.write_text("v 0 0 0\n")
    broken = type(block)(block.annotation, block.variant, block.model.model_copy(update={"hulls": [str(path)]}))
    with pytest.raises(DamagedFile, match=r"hull-00\.obj"):
        check_meshes(broken)


def test_the_library_checks_its_results(library: Library, monkeypatch: pytest.MonkeyPatch) -> None:
    seen = []
    monkeypatch.setattr("vcage.objects.library.check_points", lambda asset, path: seen.append((asset.name, path.name)))
    monkeypatch.setattr("vcage.objects.library.check_meshes", lambda asset: seen.append(asset.name))
    made = Library.load()
    made.entry("block")
    assert seen == [("block", "asset.json")]
    for _ in range(2):
        made.asset("block")
    assert seen == [("block", "asset.json"), "block"]


@pytest.mark.parametrize(("point", "distance"), [((0, 0, 0), 0.0), ((2, 0, 0), 1.0), ((4, 5, 0), 5.0)])
def test_the_distance_from_a_box_is_that_of_its_nearest_point(point, distance) -> None:
    assert outside_by(np.array([[-1, -1, -1], [1, 1, 1.0]]), point) == pytest.approx(distance)
