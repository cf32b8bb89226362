"""Debian packages from a mirror that is a folder of this machine."""

from __future__ import annotations

import platform
import shutil
import subprocess
from pathlib import Path

import pytest

from vcage.base.errors import ConfigurationError, FetchFailed, MissingDependency
from vcage.setup import apt

needs_apt = pytest.mark.skipif(shutil.which("apt-get") is None, reason="not a Debian system")


def deb(folder: Path, name: str, content: str) -> Path:
    """A Debian package with one file."""
    root = folder / f"{name}-root"
    (root / "DEBIAN").mkdir(parents=True)
    control = f"Package: {name}\nVersion: 1.8-1\nArchitecture: all\nMaintainer: x <x@example.org>\nDescription: x\n"
    (root / "DEBIAN" / "control").write_text(control)
    (root / "usr").mkdir()
    (root / "usr" / "file").write_text(content)
    target = folder / f"{name}.deb"
    command = ["dpkg-deb", "--build", "--root-owner-group", str(root), str(target)]
    subprocess.run(command, check=True, capture_output=True)
    return target


@pytest.fixture
def mirror(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """apt's configuration with one source, a folder that holds the package ``models``."""
    monkeypatch.setattr(platform, "freedesktop_os_release", lambda: {"VERSION_CODENAME": "here"})
    pool = tmp_path / "pool"
    lists = pool / "dists" / "here" / "main" / "binary-all"
    lists.mkdir(parents=True)
    package = deb(tmp_path, "models", "content")
    shutil.copy(package, pool / "models.deb")
    control = subprocess.run(["dpkg-deb", "-f", str(package)], capture_output=True, text=True, check=True).stdout
    size, digest = (
        package.stat().st_size,
        subprocess.run(["sha256sum", str(package)], capture_output=True, text=True, check=True).stdout.split()[0],
    )
    (lists / "Packages").write_text(f"{control}Filename: models.deb\nSize: {size}\nSHA256: {digest}\n\n")
    arch = subprocess.run(["dpkg", "--print-architecture"], capture_output=True, text=True, check=True).stdout.strip()
    native = lists.with_name(f"binary-{arch}")
    native.mkdir()
    shutil.copy(lists / "Packages", native / "Packages")
    root = tmp_path / "apt"
    root.mkdir()
    (root / "sources.list").write_text(f"deb [trusted=yes] file:{pool} here main\n")
    return root


@needs_apt
def test_a_package_is_downloaded_and_unpacked_without_root(mirror: Path, tmp_path: Path) -> None:
    work, target = tmp_path / "work", tmp_path / "unpacked"
    work.mkdir()
    (package,) = apt.AptMirror(work, mirror).download(["models"])
    apt.unpack_deb(package, target)
    assert apt.field_of(package, "Version") == "1.8-1"
    assert (target / "usr" / "file").read_text() == "content"


@needs_apt
def test_a_package_that_the_mirror_lacks_is_named(mirror: Path, tmp_path: Path) -> None:
    work = tmp_path / "work"
    work.mkdir()
    with pytest.raises(FetchFailed, match=r"apt-get: .*(nothing-of-this-name|Failed)"):
        apt.AptMirror(work, mirror).download(["nothing-of-this-name"])


@needs_apt
def test_missing_package_sources_are_reported(tmp_path: Path) -> None:
    with pytest.raises(ConfigurationError, match="names no package source"):
        apt.AptMirror(tmp_path, tmp_path / "nothing")


def test_a_missing_apt_is_reported(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shutil, "which", lambda name: None)
    with pytest.raises(MissingDependency, match="no apt-get"):
        apt.AptMirror(tmp_path)


@needs_apt
def test_a_damaged_package_is_an_error(tmp_path: Path) -> None:
    broken = tmp_path / "broken.deb"
    broken.write_bytes(b"not a package")
    with pytest.raises(FetchFailed, match="dpkg-deb"):
        apt.unpack_deb(broken, tmp_path / "out")
