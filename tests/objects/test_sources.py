"""The library with and without the packages that some of its models come from."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
import trimesh

from vcage.base.errors import AssetLeftOut
from vcage.objects import library as library_module
from vcage.objects.library import Library, package_models
from vcage.objects.packages.ycb import YCB


@pytest.fixture
def root(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A library of one kind, whose model comes from a package."""
    folder = tmp_path / "objects" / "brick"
    folder.mkdir(parents=True)
    annotation = {
        "schema": "vcage.asset/1",
        "name": "brick",
        "source": "ycb",
        "words": {"name": "brick", "plural": "bricks", "description": "A brick.", "category": "toy"},
        "variants": [{"id": "red", "colour": "red", "package": {"model": "061_foam_brick", "mass": 0.05}}],
    }
    (folder / "asset.json").write_text(json.dumps(annotation))
    return folder.parent


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("VCAGE_CACHE", str(tmp_path / "cache"))


@pytest.fixture
def fetched() -> Path:
    """The package's folder, with the model."""
    folder = YCB.folder
    folder.mkdir(parents=True)
    trimesh.creation.box(extents=(0.05, 0.08, 0.04)).export(folder / "061_foam_brick.stl")
    return folder


def test_without_its_package_a_kind_is_left_out_with_the_way_to_get_it(root: Path) -> None:
    library = Library.load(root)
    assert library.names == []
    assert "vcage setup assets" in library.left_out["brick"]
    with pytest.raises(AssetLeftOut, match="'brick' is not here") as caught:
        library.asset("brick")
    assert "vcage setup assets" in caught.value.hint


def test_with_its_package_a_kind_is_there_and_its_maker_named(root: Path, fetched: Path) -> None:
    asset = Library.load(root).asset("brick")
    assert asset.size == pytest.approx([0.05, 0.08, 0.04], abs=1e-5)
    assert "MIT" in (Path(asset.model.visual).parent / "ATTRIBUTION.txt").read_text()


def test_a_model_in_the_cache_needs_the_package_no_more(root: Path, fetched: Path) -> None:
    Library.load(root).asset("brick")
    shutil.rmtree(fetched)
    assert Library.load(root).asset("brick").model.mass == 0.05


def test_models_of_packages_are_known_before_they_are_fetched(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(library_module, "resource", lambda *parts: root)
    monkeypatch.setattr(library_module, "imported_objects", lambda: root / "none")
    assert package_models() == {"ycb": ["061_foam_brick"]}
