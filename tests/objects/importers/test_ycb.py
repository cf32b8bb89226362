"""Shapes of the YCB set as objects of the library."""

from __future__ import annotations

from pathlib import Path

import pytest
import trimesh

from vcage.base.errors import FetchFailed, UnknownName
from vcage.objects.importers.ycb import identifier, import_ycb
from vcage.objects.library import Library
from vcage.objects.packages.package import Package
from vcage.objects.packages.ycb import YCB
from vcage.schema.asset import Annotation
from vcage.sim.robots import load_robot

GRIPPER = load_robot("dual_panda").arms["left"].gripper


@pytest.fixture(autouse=True)
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of a set of three shapes that was fetched already."""
    monkeypatch.setenv("VCAGE_CACHE", str(tmp_path / "cache"))
    folder = YCB.folder
    folder.mkdir(parents=True)
    sizes = {"011_banana": (0.15, 0.04, 0.04), "073-a_lego_duplo": (0.06, 0.03, 0.03), "073-b_lego_duplo": (0.2,) * 3}
    for name, size in sizes.items():
        trimesh.creation.box(extents=size).export(folder / f"{name}.stl")
    return folder


def test_names_tell_the_set_and_the_shape() -> None:
    assert identifier("011_banana") == "ycb_banana"
    assert identifier("073-a_lego_duplo") == "ycb_lego_duplo_a"


def test_a_shape_becomes_an_object_that_can_be_grasped(tmp_path: Path) -> None:
    (done,) = import_ycb(["banana"], GRIPPER, tmp_path / "objects")
    assert done.name == "ycb_banana" and done.error is None
    asset = Library.load(tmp_path / "objects").asset("ycb_banana")
    assert asset.size == pytest.approx([0.15, 0.04, 0.04], abs=1e-4)
    contacts = asset.annotation.contact_points
    assert contacts and all(0.008 <= asset.grasp_width(contact) <= 0.07 for contact in contacts)


def test_words_come_from_the_name(tmp_path: Path) -> None:
    import_ycb(["073-a_lego_duplo"], GRIPPER, tmp_path)
    words = Annotation.read(tmp_path / "ycb_lego_duplo_a" / "asset.json").words
    assert (words.name, words.plural) == ("lego duplo A", "lego duplos")


def test_without_names_every_shape_is_imported(tmp_path: Path) -> None:
    steps: list[str] = []
    done = import_ycb((), GRIPPER, tmp_path, lambda step, number, total: steps.append(f"{step} {number + 1}/{total}"))
    assert len(done) == 3 and steps[0] == "011_banana 1/3"


def test_an_ungraspable_object_is_imported_with_a_warning(tmp_path: Path) -> None:
    (done,) = import_ycb(["073-b_lego_duplo"], GRIPPER, tmp_path)
    assert any("field contact_points: none found" in warning for warning in done.warnings)


def test_an_existing_object_is_kept_unless_forced(tmp_path: Path) -> None:
    import_ycb(["banana"], GRIPPER, tmp_path)
    (refused,) = import_ycb(["banana"], GRIPPER, tmp_path)
    assert refused.error is not None and "--force" in refused.error.hint
    (replaced,) = import_ycb(["banana"], GRIPPER, tmp_path, force=True)
    assert replaced.error is None


def test_an_unknown_shape_is_refused_with_the_known_ones(tmp_path: Path) -> None:
    with pytest.raises(UnknownName, match="011_banana"):
        import_ycb(["bananna"], GRIPPER, tmp_path)


def test_a_set_that_cannot_be_fetched_is_an_error(
    package: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(_self: Package, _models: object) -> None:
        raise FetchFailed("no answer")

    for path in package.iterdir():
        path.unlink()
    monkeypatch.setattr(Package, "fetch", fails)
    with pytest.raises(FetchFailed, match="no answer"):
        import_ycb(["banana"], GRIPPER, tmp_path)
