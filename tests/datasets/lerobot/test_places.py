from __future__ import annotations

import os
import shutil

import pytest

from vcage.base.errors import DamagedFile
from vcage.datasets.lerobot.places import inside, own_file, own_files, placed

NAMES = {"video_key": "observation.images.top", "episode_index": 7, "episode_chunk": 0}


@pytest.fixture
def root(tmp_path):
    folder = tmp_path / "set"
    (folder / "data").mkdir(parents=True)
    (folder / "meta").mkdir()
    (folder / "data/file.parquet").write_bytes(b"PAR1")
    return folder


def test_a_pattern_is_filled_in_below_the_data_set(root):
    pattern = "videos/chunk-{episode_chunk:03d}/{video_key}/episode_{episode_index:06d}.mp4"
    found = placed(root, "video_path", pattern, **NAMES)
    assert found == root / "videos/chunk-000/observation.images.top/episode_000007.mp4"


@pytest.mark.parametrize(
    "pattern",
    [
        "/etc/passwd",
        "../other/{episode_index}.parquet",
        "data/../../x",
        "{video_key}/{episode_index.__class__}",
        "{episode_index!r}",
        "{episode_index:9999999999d}",
        "{unknown}",
        "{}",
        "{video_key:03d}",
        "a\0b",
        "",
        ["a"],
        None,
    ],
)
def test_a_pattern_that_leads_out_or_cannot_be_filled_in_is_refused_by_file_and_field(root, pattern):
    with pytest.raises(DamagedFile, match=r"meta/info\.json: video_path"):
        placed(root, "video_path", pattern, **NAMES)


def test_a_path_in_a_table_is_refused_with_the_field_that_names_it():
    with pytest.raises(DamagedFile, match="the table names the path '/etc/passwd'"):
        inside("/etc/passwd", "the table")


@pytest.mark.parametrize(
    ("link", "target"),
    [("meta/notes.txt", "secret.txt"), ("meta/a.json", "keys.json"), ("data/a.parquet", "secret.txt")],
)
def test_a_link_to_any_file_outside_is_refused(root, tmp_path, link, target):
    (tmp_path / target).write_text("secret")
    (root / link).symlink_to(tmp_path / target)
    with pytest.raises(DamagedFile, match=f"{link} is a link to .*{target}, outside the data set"):
        own_files(root)


def test_a_linked_folder_is_not_a_way_out(root, tmp_path):
    (tmp_path / "home").mkdir()
    (tmp_path / "home/.netrc").write_text("secret")
    (root / "x").symlink_to(tmp_path / "home")
    with pytest.raises(DamagedFile, match="outside the data set"):
        placed(root, "data_path", "x/.netrc")


def test_videos_and_tables_may_lie_on_another_disk(root, tmp_path):
    shutil.move(root / "data", tmp_path / "elsewhere")
    (root / "data").symlink_to(tmp_path / "elsewhere")
    assert own_file(root, own_files(root)[0]) == root / "data/file.parquet"


@pytest.mark.parametrize("subfolder", ["", "one/two"])
def test_the_cache_of_hugging_face_is_a_data_sets_own(tmp_path, subfolder):
    blobs = tmp_path / "datasets--a--b/blobs"
    root = tmp_path / "datasets--a--b/snapshots/0123" / subfolder
    blobs.mkdir(parents=True)
    (root / "meta").mkdir(parents=True)
    (blobs / "ab").write_text("{}")
    (root / "meta/any.json").symlink_to(os.path.relpath(blobs / "ab", root / "meta"))
    assert list(map(str, own_files(root))) == ["meta/any.json"]


def test_hidden_files_except_the_hubs_description_are_not_part_of_a_data_set(root):
    for name in (".gitattributes", ".DS_Store", "._x", "data/._file.parquet", ".cache/a", "data/.ipynb_checkpoints/a"):
        (root / name).parent.mkdir(exist_ok=True)
        (root / name).touch()
    assert list(map(str, own_files(root))) == ["data/file.parquet", ".gitattributes"]


def test_a_file_of_a_data_set_that_was_not_fetched_is_named(root):
    (root / "README.md").write_text("version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n")
    with pytest.raises(DamagedFile, match=r"README\.md is a Git LFS pointer"):
        own_files(root)


def test_a_folder_that_is_not_there_has_no_files(root, tmp_path):
    assert own_files(root, root / "meta/episodes") == []
