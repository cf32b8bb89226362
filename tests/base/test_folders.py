from __future__ import annotations

import os

import pytest

from vcage.base.errors import InputFileError, OutputFolderError
from vcage.base.folders import entries, files_below, is_empty_folder, natural_key, real_path, require_utf8, size_of


def made(folder, *names):
    for name in names:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).touch()
    return folder


def listed(folder, **options):
    return [path.relative_to(folder).as_posix() for path in files_below(folder, **options)]


def test_numbers_in_names_are_compared_as_numbers():
    names = ["episode_10", "episode_2", "demo_1_10", "demo_1_9", "episode_02", "²", "x" + "9" * 5000, "x1"]
    assert sorted(names, key=natural_key) == [
        *("demo_1_9", "demo_1_10", "episode_02", "episode_2", "episode_10"),
        *("x1", "x" + "9" * 5000, "²"),
    ]


def test_files_below_a_folder_come_in_natural_order_folder_by_folder(tmp_path):
    made(tmp_path, "chunk-1000/a", "chunk-999/file-10", "chunk-999/file-9")
    assert listed(tmp_path) == ["chunk-999/file-9", "chunk-999/file-10", "chunk-1000/a"]


def test_hidden_names_are_passed_over(tmp_path):
    made(tmp_path, "._a", ".DS_Store", ".cache/a", "a/.ipynb_checkpoints/b", "a/._b", "a/b")
    assert listed(tmp_path) == ["a/b"]
    assert entries(tmp_path) == [tmp_path / "a"]


def test_a_folder_with_hidden_names_holds_nothing(tmp_path):
    assert is_empty_folder(made(tmp_path, ".DS_Store"))
    assert not is_empty_folder(made(tmp_path, "a"))


def test_a_hidden_folder_that_was_named_is_searched(tmp_path):
    assert listed(made(tmp_path / ".data", "a")) == ["a"]


def test_linked_folders_are_searched_and_loops_entered_once(tmp_path):
    elsewhere, folder = made(tmp_path / "elsewhere", "b"), made(tmp_path / "data", "a")
    (folder / "more").symlink_to(elsewhere)
    (folder / "self").symlink_to(folder)
    (elsewhere / "back").symlink_to(folder)
    assert listed(folder) == ["a", "more/b"]


def test_a_folder_with_two_names_is_listed_once_under_its_real_one(tmp_path):
    folder = made(tmp_path, "real/a")
    (folder / "alias").symlink_to(folder / "real")
    assert listed(folder) == ["real/a"]
    assert listed(folder, repeated=True) == ["alias/a", "real/a"]


def test_a_link_without_a_target_counts_as_a_file(tmp_path):
    (tmp_path / "a.hdf5").symlink_to("nowhere")
    assert listed(tmp_path) == ["a.hdf5"]


def test_links_that_multiply_folders_are_refused(tmp_path):
    for level in range(6):
        made(tmp_path, f"{level}/a")
        for name in ("x", "y"):
            (tmp_path / f"{level}/{name}").symlink_to(tmp_path / f"{level + 1}")
    with pytest.raises(InputFileError, match="more than 50 folders"):
        files_below(tmp_path, repeated=True, max_folders=50)


def test_a_path_that_is_not_utf8_is_refused_and_shown_with_escapes(tmp_path):
    bad = tmp_path / os.fsdecode(b"x\xff")
    with pytest.raises(InputFileError, match=r"x\\xff is not UTF-8") as caught:
        require_utf8(bad)
    caught.value.message.encode()
    with pytest.raises(OutputFolderError):
        require_utf8(bad, OutputFolderError)


def test_a_file_with_two_names_counts_once_in_the_size_of_a_folder(tmp_path):
    (tmp_path / "a").mkdir()
    (tmp_path / "a" / "video").write_bytes(bytes(100))
    (tmp_path / "again").hardlink_to(tmp_path / "a" / "video")
    (tmp_path / "link").symlink_to(tmp_path / "a")
    assert size_of(tmp_path) == (100, 3)
    assert size_of(tmp_path / "none") == (0, 0)


def test_a_path_that_leads_nowhere_is_named(tmp_path):
    (tmp_path / "circle").symlink_to("circle")
    for path in (tmp_path / "circle", "~nobody-of-this-name/runs"):
        with pytest.raises(OutputFolderError, match="is no folder"):
            real_path(path)
    (tmp_path / "link").symlink_to(tmp_path / "later")
    assert real_path(tmp_path / "link") == tmp_path.resolve() / "later"
