"""Importing folders of RoboTwin objects: names, many at once, and interruption."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from tests.objects.importers.conftest import TOP_DOWN, Cabinet, Rigid, frame
from vcage.base.errors import InputFileError, SchemaMismatch
from vcage.objects.importers import robotwin
from vcage.objects.importers.robotwin import import_robotwin
from vcage.objects.importers.robotwin_words import LONGEST, called, identifier, plural, unique
from vcage.objects.library import Library


def test_a_folder_of_many_is_imported_with_its_bad_objects_reported(rigid, cabinet, into):
    cabinet.write()
    rigid.data["scale"] = [0, 0, 0]
    rigid.write()
    (rigid.folder.parent / "001_nothing").mkdir()
    entries = import_robotwin(rigid.folder.parent, into)
    assert {e.name: e.error is None for e in entries} == {
        "rt_nothing": False, "rt_deep-tray": False, "rt_cabinet": True
    }  # fmt: skip
    assert Library.load(into).names == ["rt_cabinet"]


def test_an_empty_object_error_lists_the_expected_files(rigid, into):
    (rigid.folder.parent / "001_nothing").mkdir(parents=True)
    (entry,) = import_robotwin(rigid.folder.parent, into)
    assert "001_nothing is empty; expected visual/base0.glb" in entry.error.message


@pytest.mark.parametrize("name", ["", "missing"])
def test_a_folder_without_objects_is_refused(tmp_path, into, name):
    (tmp_path / "empty").mkdir()
    with pytest.raises(InputFileError, match=r"no RoboTwin object|not a folder"):
        import_robotwin(tmp_path / "empty" / name, into)


def test_the_folder_above_objects_serves_too(rigid, into):
    rigid.write()
    assert [e.name for e in import_robotwin(rigid.folder.parents[1], into)] == ["rt_deep-tray"]


def test_a_name_that_occurs_twice_is_refused_naming_both(rigid, into):
    rigid.write()
    Rigid(rigid.folder.parent / "114_deep-tray").write()
    first, second = import_robotwin(rigid.folder.parent, into)
    assert first.error is None
    assert "114_deep-tray: field name: 'rt_deep-tray' is the name of" in second.error.message
    assert str(into / "rt_deep-tray") in second.error.message


def test_an_imported_object_is_replaced_only_by_force(rigid, into):
    import_robotwin(rigid.write().folder, into)
    (again,) = import_robotwin(rigid.folder, into)
    assert "is the name of" in again.error.message and "--force" in again.error.hint
    (forced,) = import_robotwin(rigid.folder, into, force=True)
    assert forced.error is None


def test_an_interrupted_import_leaves_no_half_object(rigid, into, monkeypatch):
    def stop(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(robotwin, "check_points", stop)
    with pytest.raises(KeyboardInterrupt):
        import_robotwin(rigid.write().folder, into)
    assert list(into.glob("*")) == []


def test_damaged_points_info_is_warned_of(rigid, into):
    rigid.write()
    (rigid.folder / "points_info.json").write_text("[]")
    (entry,) = import_robotwin(rigid.folder, into)
    assert "points_info.json" in entry.warnings[0]


@pytest.mark.parametrize(
    ("field", "value", "message"),
    [
        ("scale", 10**400, r"model_data0.json: field scale: got 1000.*expected three numbers"),
        ("scale", [1e300] * 3, r"model_data0.json: field scale: .*expected 1e-06 … 1e\+06"),
        ("scale", [1e-300] * 3, r"model_data0.json: field scale: .*expected 1e-06 … 1e\+06"),
        ("scale", [1e6] * 3, r"model_data0.json: field scale: .*expected 0.005 … 2.0 m"),
        ("scale", [1e-6] * 3, r"model_data0.json: field scale: .*expected 0.005 … 2.0 m"),
        ("init_qpos", [10**400], r"model_data0.json: field init_qpos: got .*expected a list of numbers"),
    ],
)
def test_a_number_that_nothing_can_be_made_with_refuses_only_its_object(rigid, into, field, value, message):
    Rigid(rigid.folder.parent / "001_tray").write()
    rigid.data[field] = value
    rigid.write()
    good, bad = import_robotwin(rigid.folder.parent, into)
    assert good.error is None
    assert isinstance(bad.error, SchemaMismatch)
    with pytest.raises(SchemaMismatch, match=message):
        raise bad.error


def test_a_number_of_too_many_digits_is_a_damaged_file(rigid, into):
    rigid.write()
    (rigid.folder / "model_data0.json").write_text('{"scale": ' + "1" * 5000 + "}")
    (entry,) = import_robotwin(rigid.folder, into)
    assert entry.error.code == "damaged_file"


@pytest.mark.parametrize("value", [5, "none", {"a": 1}, [[[10**400] * 4] * 4]])
def test_contact_points_other_than_a_list_of_matrices_cause_a_warning(rigid, into, value):
    rigid.data["contact_points_pose"] = value
    (entry,) = import_robotwin(rigid.write().folder, into)
    assert entry.error is None
    assert any("field contact_points_pose" in warning and "4×4" in warning for warning in entry.warnings)


def test_a_refused_record_names_file_field_and_value(rigid, into, monkeypatch):
    monkeypatch.setattr(robotwin, "called", lambda folder: "")
    (entry,) = import_robotwin(rigid.write().folder, into)
    assert f"{rigid.folder}: field name: String should have at least 1 character; got ''" == entry.error.message
    assert (entry.error.code, entry.error.details["field"]) == ("schema_mismatch", "name")


def test_variants_with_similar_folder_names_keep_different_ids(cabinet, into):
    for name in ("A b", "a_b"):
        shutil.copytree(cabinet.write().folder, cabinet.folder.parent / name)
    shutil.rmtree(cabinet.folder)
    (entry,) = import_robotwin(cabinet.folder.parent, into)
    assert entry.error is None
    assert Library.load(into).variants() == [("rt_cabinet", "a_b"), ("rt_cabinet", "a_b_2")]


def test_groups_of_variants_keep_different_names(rigid, into):
    for name, x in (("x", -0.55), ("1", -0.54), ("base1", -0.53)):
        cabinet = Cabinet(rigid.folder.parent / "036_cabinet" / name)
        cabinet.data["contact_points"][0]["matrix"][0][3] = x
        cabinet.write()
    entries = import_robotwin(rigid.folder.parent, into)
    assert [e.name for e in entries] == ["rt_cabinet", "rt_cabinet_x", "rt_cabinet_1"]
    assert [e.error for e in entries] == [None] * 3


def test_when_a_later_group_fails_its_check_none_is_left(rigid, into, monkeypatch):
    rigid.write()
    rigid.data["contact_points_pose"] = [frame(TOP_DOWN, [5, 2.8, 0])]
    rigid.write(3)

    def check(asset, path: Path) -> None:
        if asset.annotation.name.endswith("_3"):
            raise SchemaMismatch(f"{path}: field contact_points.0.position: off the object")

    monkeypatch.setattr(robotwin, "check_points", check)
    (entry,) = import_robotwin(rigid.folder, into)
    assert "rt_deep-tray_3" in entry.error.message
    assert list(into.glob("*")) == []


@pytest.mark.parametrize(
    ("folder", "name", "words"),
    [
        ("004__", "rt_004", "object 004"),
        ("004_", "rt_004", "object 004"),
        ("005_杯子", "rt_005", "object 005"),
        ("006_cup杯", "rt_cup_", "cup杯"),
        ("杯子", "rt_object", "object"),
    ],
)
def test_a_folder_without_a_latin_name_is_called_by_its_number(tmp_path, into, folder, name, words):
    source = tmp_path / "objects" / folder
    assert (identifier(source), called(source)) == (name, words)
    (entry,) = import_robotwin(Rigid(source).write().folder, into)
    assert (entry.name, entry.error) == (name, None)
    assert Library.load(into).annotation(name).words.name == words


def test_a_number_makes_a_name_unique_within_its_length():
    long = "a" * (LONGEST + 5)
    first = unique(long, [])
    second = unique(long, [first])
    assert (len(first), len(second), second[-2:]) == (LONGEST, LONGEST, "_2")


def test_progress_names_each_object(rigid, cabinet, into):
    rigid.write(), cabinet.write()
    seen = []
    import_robotwin(rigid.folder.parent, into, lambda *step: seen.append(step))
    assert seen == [("003_deep-tray", 0, 2), ("036_cabinet", 1, 2)]


def test_names_become_identifiers(tmp_path):
    assert identifier(tmp_path / "073_rubiksCube") == "rt_rubikscube"
    assert identifier(tmp_path / "112_tea-box") == "rt_tea-box"


@pytest.mark.parametrize(("name", "many"), [("plate", "plates"), ("tea box", "tea boxes"), ("battery", "batteries")])
def test_plurals_are_regular(name, many):
    assert plural(name) == many
