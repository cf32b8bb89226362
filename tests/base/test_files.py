"""A file or folder appears whole or not at all."""

from __future__ import annotations

import errno
import os
from pathlib import Path

import pytest

from vcage.base import files
from vcage.base.errors import DamagedFile, DiskFull, MissingStage, OutputFolderError


def test_written_json_reads_back(tmp_path):
    files.write_json(tmp_path / "deep" / "a.json", {"b": [1, "ü"]})
    assert files.read_json(tmp_path / "deep" / "a.json") == {"b": [1, "ü"]}


def test_a_failed_write_leaves_the_old_file_and_nothing_else(tmp_path):
    path = files.write_text(tmp_path / "a.txt", "old")
    with pytest.raises(RuntimeError), files.atomic_path(path) as part:
        part.write_text("half")
        raise RuntimeError
    assert path.read_text() == "old"
    assert [p.name for p in tmp_path.iterdir()] == ["a.txt"]


def test_a_failed_folder_leaves_the_old_folder(tmp_path):
    with files.atomic_folder(tmp_path / "stage") as folder:
        (folder / "a").write_text("old")
    with pytest.raises(RuntimeError), files.atomic_folder(tmp_path / "stage") as folder:
        (folder / "a").write_text("half")
        raise RuntimeError
    assert (tmp_path / "stage" / "a").read_text() == "old"
    assert len(list(tmp_path.iterdir())) == 1


def test_a_full_disk_is_named_as_such(tmp_path):
    with pytest.raises(DiskFull, match="no space left"), files.atomic_path(tmp_path / "a"):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    assert not list(tmp_path.iterdir())


def test_a_read_only_folder_is_named_as_such(tmp_path):
    with pytest.raises(OutputFolderError, match="cannot write"), files.atomic_path(tmp_path / "a"):
        raise OSError(errno.EROFS, os.strerror(errno.EROFS))


def test_an_output_folder_that_is_a_file_is_refused(tmp_path):
    (tmp_path / "run").write_text("")
    with pytest.raises(OutputFolderError):
        files.RunFolder(tmp_path / "run").make()


def test_a_missing_file_names_the_way_out(tmp_path):
    with pytest.raises(MissingStage, match="does not exist") as caught:
        files.read_json(tmp_path / "place" / "scene.json")
    assert (caught.value.hint, caught.value.maker) == ("the stage that writes it comes first", "select_place")


def test_broken_json_is_damaged(tmp_path):
    (tmp_path / "scene.json").write_text('{"a": ')
    with pytest.raises(DamagedFile, match="not valid JSON"):
        files.read_json(tmp_path / "scene.json")


def test_cache_dir_follows_the_environment(tmp_path, monkeypatch):
    monkeypatch.setenv("VCAGE_CACHE", str(tmp_path / "c"))
    assert files.cache_dir("assets") == tmp_path / "c" / "assets"
    assert (tmp_path / "c" / "assets").is_dir()


def test_records_name_files_relative_to_the_run(tmp_path):
    run = files.RunFolder(tmp_path)
    assert run.relative(run.scene) == "place/scene.json"


@pytest.mark.skipif(not Path("/proc/self").is_dir(), reason="no /proc")
def test_where_the_system_makes_no_folder_another_is_asked_for():
    with pytest.raises(OutputFolderError, match="/proc/vcage") as caught:
        files.RunFolder("/proc/vcage").make()
    assert "--out" in caught.value.hint


def test_a_cache_that_cannot_be_made_names_its_variable(tmp_path, monkeypatch):
    (tmp_path / "file").touch()
    monkeypatch.setenv("VCAGE_CACHE", str(tmp_path / "file" / "cache"))
    with pytest.raises(OutputFolderError) as caught:
        files.cache_dir("assets")
    assert "VCAGE_CACHE" in caught.value.hint
