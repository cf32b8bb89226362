"""``vcage assets import``."""

from __future__ import annotations

import pytest

from tests.cli.command import run
from tests.objects.importers.conftest import Rigid
from vcage.base.commands import vcage_command

pytestmark = pytest.mark.usefixtures("data")


def test_objects_are_imported_where_the_library_finds_them(tmp_path, data, capsys):
    rigid = Rigid(tmp_path / "objects" / "003_tray").write(collision=False)
    code, record, text = run(capsys, "assets", "import", "robotwin", rigid.folder)
    assert code == 0
    assert record["summary"] == {"imported": ["rt_tray"], "warnings": 1, "refused": []}
    assert "rt_tray: imported" in text and "warning: " in text
    assert record["next"] == vcage_command("assets", "gallery", "rt_tray")
    assert (data / "objects" / "rt_tray" / "asset.json").is_file()


def test_objects_put_elsewhere_have_no_gallery_that_finds_them(tmp_path, capsys):
    rigid = Rigid(tmp_path / "objects" / "003_tray").write()
    code, record, _ = run(capsys, "assets", "import", "robotwin", rigid.folder, "--into", tmp_path / "in")
    assert (code, record["output"], record["next"]) == (0, str(tmp_path / "in"), None)


def test_a_bad_object_among_good_ones_is_listed_with_its_fault(tmp_path, capsys):
    Rigid(tmp_path / "objects" / "003_tray").write()
    bad = Rigid(tmp_path / "objects" / "004_bad")
    bad.data["scale"] = 0
    bad.write()
    code, record, text = run(capsys, "assets", "import", "robotwin", tmp_path / "objects", "--into", tmp_path / "in")
    (refused,) = record["summary"]["refused"]
    assert (code, record["summary"]["imported"]) == (0, ["rt_tray"])
    assert (refused["name"], refused["details"]["field"]) == ("rt_bad", "scale")
    assert "rt_bad: refused: " in text


def test_one_refused_object_is_the_error(tmp_path, capsys):
    bad = Rigid(tmp_path / "004_bad")
    bad.data["scale"] = 0
    code, record, _ = run(capsys, "assets", "import", "robotwin", bad.write().folder)
    assert (code, record["error"]["code"], record["error"]["details"]["field"]) == (3, "schema_mismatch", "scale")


def test_many_refused_objects_are_one_error(tmp_path, capsys):
    for name in ("001_a", "002_b"):
        (tmp_path / "objects" / name).mkdir(parents=True)
    code, record, _ = run(capsys, "assets", "import", "robotwin", tmp_path)
    assert (code, len(record["error"]["details"]["refused"])) == (3, 2)


@pytest.mark.parametrize("folders", [[], ["a", "b"]])
def test_robotwin_takes_one_folder(capsys, folders):
    code, record, _ = run(capsys, "assets", "import", "robotwin", *folders)
    assert (code, record["error"]["code"]) == (2, "usage")


def test_names_of_the_ycb_set_are_handed_on(tmp_path, capsys, monkeypatch):
    from vcage.objects.importers import Imported, ycb

    asked = []

    def import_ycb(names, gripper, into, progress, *, force):
        asked.append((names, into, force))
        return [Imported("ycb_banana", tmp_path / "ycb_banana")]

    monkeypatch.setattr(ycb, "import_ycb", import_ycb)
    code, record, _ = run(capsys, "assets", "import", "ycb", "banana", "--into", tmp_path, "--force")
    assert (code, record["summary"]["imported"], asked) == (0, ["ycb_banana"], [(["banana"], tmp_path, True)])
