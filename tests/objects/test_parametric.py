"""Objects of an own folder: an annotation and a model.py, here those shown in docs/assets.md."""

from __future__ import annotations

import os
import re
import shutil
import sys
from pathlib import Path

import pytest

from vcage.base.errors import InputFileError, SchemaMismatch
from vcage.base.files import resource
from vcage.cli.main import main
from vcage.objects import parametric
from vcage.objects.catalogue import UNBUILT, catalogue_line
from vcage.objects.library import Library
from vcage.objects.points import check_points


def _example(language: str) -> str:
    """The block of a language under "To add an object"."""
    section = resource("docs", "assets.md").read_text().split("## To add an object")[1]
    found = re.search(rf"```{language}\n(.*?)```", section, re.DOTALL)
    assert found is not None
    return found[1]


@pytest.fixture
def objects(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder of one object, which VCAGE_ASSETS names, and an empty cache."""
    folder = tmp_path / "objects" / "candle"
    folder.mkdir(parents=True)
    (folder / "asset.json").write_text(_example("json"))
    (folder / "model.py").write_text(_example("python"))
    monkeypatch.setenv("VCAGE_ASSETS", str(folder.parent))
    monkeypatch.setenv("VCAGE_CACHE", str(tmp_path / "cache"))
    return folder.parent


@pytest.fixture
def model(objects: Path) -> Path:
    return objects / "candle" / "model.py"


def test_an_object_of_an_own_folder_stands_beside_the_projects(objects: Path) -> None:
    library = Library.load()
    assert {"candle", "mug"} <= set(library.names)
    assert library.variants(["candle"]) == [("candle", "white"), ("candle", "tall")]
    heights = {variant: library.asset("candle", variant).size[2] for variant in ("white", "tall")}
    assert heights == pytest.approx({"white": 0.08, "tall": 0.11})
    check_points(library.asset("candle"), objects / "candle" / "asset.json")


def test_it_can_be_grasped_and_listed(objects: Path) -> None:
    entry = Library.load().entry("candle")
    assert entry.words.plural == "candles"
    assert Library.load().asset("candle").grasp_width(entry.contact_points[0]) == pytest.approx(0.05)


@pytest.mark.parametrize("line", [["list"], ["list", "--json"], ["search", "candle"]], ids=" ".join)
def test_listing_and_searching_execute_nothing_in_a_named_folder(objects, model, line, capsys, monkeypatch):
    monkeypatch.setattr("vcage.objects.library.object_folders", lambda: [objects])  # ours take long to build
    executed = objects / "executed"
    model.write_text(f"open({str(executed)!r}, 'w')\n{model.read_text()}")
    assert main(["assets", *line]) == 0
    assert "candle" in capsys.readouterr().out or line[1:] == ["--json"]
    assert not executed.exists()
    Library.load().entry("candle")
    assert executed.exists(), "building does"


def test_an_unbuilt_asset_is_listed_without_a_size(objects: Path) -> None:
    (before,) = Library.load(objects).listing()
    assert UNBUILT in catalogue_line(before) and before.contact_points
    Library.load(objects).entry("candle")
    (after,) = Library.load(objects).listing()
    assert after == Library.load(objects).entry("candle") and UNBUILT not in catalogue_line(after)


def test_it_is_built_with_the_rest(objects: Path) -> None:
    library = Library.load(objects)
    assert library.unbuilt() == [("candle", "white"), ("candle", "tall")]
    assert library.build_all() == []
    assert library.unbuilt() == []


def test_building_does_not_depend_on_the_working_folder(objects: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(objects)
    monkeypatch.setattr(sys, "path", [path for path in sys.path if Path(path).resolve() != resource().resolve()])
    before = list(sys.path)
    assert len(parametric.build(resource("assets", "objects", "mug"), "white").parts) == 1
    assert sys.path == before


def test_objects_imported_under_the_name_of_assets_stay(objects: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    theirs = type(sys)("assets")
    monkeypatch.setitem(sys.modules, "assets", theirs)
    parametric.build(resource("assets", "objects", "basket"), "natural")
    assert sys.modules["assets"] is theirs


def test_a_missing_folder_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("VCAGE_ASSETS", os.pathsep.join([str(tmp_path / "mine"), str(tmp_path)]))
    with pytest.raises(InputFileError, match=r"VCAGE_ASSETS: .*mine is not a folder"):
        Library.load()


def test_a_folder_without_objects_is_named(objects: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("VCAGE_ASSETS", str(objects / "candle"))
    with pytest.raises(InputFileError, match=r"VCAGE_ASSETS: no asset\.json under .*candle"):
        Library.load()


def test_a_name_of_the_projects_own_is_refused(objects: Path) -> None:
    shutil.copytree(resource("assets", "objects", "mug"), objects / "mug")
    with pytest.raises(SchemaMismatch, match=r"field name: 'mug' is the name of .* already"):
        Library.load()


def test_an_annotation_without_a_builder_is_refused(model: Path) -> None:
    model.unlink()
    with pytest.raises(
        InputFileError, match=r"'candle' has an annotation but no builder: there is no .*candle/model\.py"
    ):
        Library.load().asset("candle")


def test_a_builder_that_lacks_a_variant_is_refused(model: Path) -> None:
    model.write_text(model.read_text().replace('"tall"', '"short"'))
    with pytest.raises(InputFileError, match="the builder of asset 'candle' knows no variant 'tall'"):
        Library.load().asset("candle", "tall")


def test_a_model_without_the_function_is_refused(model: Path) -> None:
    model.write_text(model.read_text().replace("def build(", "def make("))
    with pytest.raises(InputFileError, match=r"candle/model\.py: there is no function build"):
        Library.load().asset("candle")


@pytest.mark.parametrize("spoilt", ["def build(variant:", "import no_such_module_at_all", "1 / 0"])
def test_a_model_that_cannot_be_imported_is_refused(model: Path, spoilt: str) -> None:
    model.write_text(spoilt)
    with pytest.raises(InputFileError, match=r"candle/model\.py: it cannot be imported: \w+Error: "):
        Library.load().asset("candle")


def test_a_model_that_returns_something_else_is_refused(model: Path) -> None:
    model.write_text("def build(variant):\n    return None\n")
    with pytest.raises(InputFileError, match=r"build\('white'\) returned a NoneType; expected a BuiltObject"):
        Library.load().asset("candle")


def test_a_builder_that_fails_is_refused_with_the_line(model: Path) -> None:
    model.write_text("def build(variant):\n    return {}['wick']\n")
    with pytest.raises(InputFileError, match=r"candle/model\.py: build\('white'\) failed in line 2: KeyError: 'wick'"):
        Library.load().asset("candle")


def test_a_model_is_rebuilt_when_it_or_its_imports_change(objects: Path, tmp_path: Path) -> None:
    def digest(name: str, text: str) -> str:
        folder = tmp_path / name
        folder.mkdir()
        (folder / "model.py").write_text(text)
        return parametric.sources_hash(folder)

    text = _example("python")
    assert digest("a", text) == parametric.sources_hash(objects / "candle")
    assert digest("b", text.replace("0.08", "0.09")) != digest("c", text)
    unused = digest("d", text + "\nfrom assets.shapes import lumps\n")
    assert unused != digest("e", text + "\nfrom assets.shapes import ring_pastry\n")
