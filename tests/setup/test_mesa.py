"""Fetching Mesa's software driver, without the network."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path

import pytest

from vcage.base.errors import NoRenderer
from vcage.setup import mesa

needs_dpkg = pytest.mark.skipif(shutil.which("dpkg-deb") is None, reason="not a Debian system")


def package(folder: Path, name: str, depends: str, *files: str) -> Path:
    """A Debian package with some files, which are empty unless they are manifests."""
    root = folder / name
    (root / "DEBIAN").mkdir(parents=True)
    control = f"Package: {name}\nVersion: 1\nArchitecture: all\nMaintainer: x <x@example.org>\nDescription: x\n"
    (root / "DEBIAN" / "control").write_text(control + (f"Depends: {depends}\n" if depends else ""))
    for file in files:
        path = root / file
        path.parent.mkdir(parents=True, exist_ok=True)
        manifest = {"ICD": {"library_path": "relative.so", "api_version": "1.4"}, "file_format_version": "1.0.0"}
        path.write_text(json.dumps(manifest) if path.suffix == ".json" else "")
    target = folder / f"{name}.deb"
    subprocess.run(
        ["dpkg-deb", "--build", "--root-owner-group", str(root), str(target)], check=True, capture_output=True
    )
    return target


def test_without_apt_the_packages_to_install_are_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shutil, "which", lambda name: None)
    with pytest.raises(NoRenderer, match="no apt-get") as caught:
        mesa.install(tmp_path / "mesa")
    assert "lavapipe" in caught.value.hint
    assert not (tmp_path / "mesa").exists()


@needs_dpkg
def test_the_manifest_names_the_driver_where_it_will_lie(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    library, manifest = "usr/lib/x86_64-linux-gnu/libvulkan_lvp.so", "usr/share/vulkan/icd.d/lvp_icd.json"
    other = "usr/lib/x86_64-linux-gnu/libvulkan_intel.so"
    deb = package(tmp_path, "mesa-vulkan-drivers", "", library, manifest, other)
    monkeypatch.setattr(mesa, "_download", lambda work: [deb])
    icd = mesa.install(tmp_path / "mesa")
    assert json.loads(icd.read_text())["ICD"]["library_path"] == str(tmp_path / "mesa" / library)
    assert (tmp_path / "mesa" / library).exists()
    assert not (tmp_path / "mesa" / other).exists()


@needs_dpkg
def test_a_package_without_lavapipe_leaves_the_earlier_driver(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "mesa"
    folder.mkdir()
    (folder / "before").touch()
    deb = package(tmp_path, "mesa-vulkan-drivers", "", "usr/share/doc/readme")
    monkeypatch.setattr(mesa, "_download", lambda work: [deb])
    with pytest.raises(NoRenderer, match="holds no lavapipe"):
        mesa.install(folder)
    assert (folder / "before").exists()


@needs_dpkg
def test_only_libraries_that_the_machine_lacks_are_fetched(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    depends = "libhere1 (>= 2), libold1 (>= 9), libc6 (>= 99), python3:any, libnone1 | libhere1, libgone1 | libgone2"
    deb = package(tmp_path, "mesa-vulkan-drivers", depends)
    installed = {"libhere1": "3", "libold1": "8"}

    def satisfied(name: str, operator: str, version: str) -> bool:
        return name in installed and (not version or int(installed[name]) >= int(version))

    monkeypatch.setattr(mesa, "_satisfied", satisfied)
    assert mesa._lacking(deb) == {"libold1", "libgone1"}


@needs_dpkg
def test_versions_of_installed_packages_are_compared_as_dpkg_does() -> None:
    assert mesa._satisfied("dpkg", ">=", "1.0~")
    assert not mesa._satisfied("dpkg", ">=", "999:1")
    assert not mesa._satisfied("no-such-package-anywhere", "", "")
