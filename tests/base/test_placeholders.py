from __future__ import annotations

import os

import pytest

from vcage.base.errors import DamagedFile
from vcage.base.placeholders import require_fetched


@pytest.mark.parametrize(
    ("content", "named"),
    [
        (b"version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 12\n", "git lfs pull"),
        (b"version https://hawser.github.com/spec/v1\noid sha256:00\nsize 12\n", "git lfs pull"),
        (b"/annex/objects/SHA256E-s12--00.mp4\n", "git annex get"),
        (b"# xet version 0\nfilesize = 12\n", "git xet checkout"),
        (b"\x00\x05\x16\x07\x00\x02\x00\x00", "AppleDouble"),
    ],
)
def test_a_pointer_file_is_named_with_the_command_that_fetches_it(tmp_path, content, named):
    (tmp_path / "a.mp4").write_bytes(content)
    with pytest.raises(DamagedFile, match=rf"a\.mp4 is .*{named}"):
        require_fetched(tmp_path / "a.mp4")


@pytest.mark.parametrize(
    ("target", "named"),
    [
        ("../../blobs/0123", "hf download"),
        (".git/annex/objects/a/b.mp4", "git annex get"),
        ("gone.mp4", "a link to gone.mp4, which is not there"),
    ],
)
def test_a_link_without_a_target_is_named_with_the_way_to_fetch_it(tmp_path, target, named):
    (tmp_path / "a.mp4").symlink_to(target)
    with pytest.raises(DamagedFile, match=named):
        require_fetched(tmp_path / "a.mp4")


def test_a_pipe_is_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "a.hdf5")
    with pytest.raises(DamagedFile, match="is no regular file but a pipe"):
        require_fetched(tmp_path / "a.hdf5")


def test_a_link_to_itself_is_named(tmp_path):
    (tmp_path / "a.hdf5").symlink_to("a.hdf5")
    with pytest.raises(DamagedFile, match=r"a\.hdf5 cannot be read"):
        require_fetched(tmp_path / "a.hdf5")


def test_a_file_with_its_own_content_passes(tmp_path):
    (tmp_path / "a").write_bytes(b"version 1")
    require_fetched(tmp_path / "a")
    require_fetched(tmp_path / "not there")
