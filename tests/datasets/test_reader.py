from __future__ import annotations

import numpy as np
import pytest

from tests.datasets.packed_files import pack
from tests.recordings import CAMERAS, written
from vcage.base.errors import DamagedFile, InputFileError
from vcage.datasets.reader import EpisodeReader


@pytest.fixture(scope="module")
def packed(tmp_path_factory):
    """An episode and the same with its pictures in videos."""
    folder = tmp_path_factory.mktemp("reader")
    source = written(folder / "episode.hdf5", 6)
    return source, pack(source, folder / "small/episode.hdf5")


def test_an_episode_whose_pictures_lie_in_videos_says_so_and_how_to_put_them_back(packed):
    with EpisodeReader(packed[1]) as reader, pytest.raises(InputFileError, match="is compressed") as refused:
        reader.images("cam_high")
    assert f"vcage decompress {packed[1]}" in refused.value.hint


def test_everything_else_of_it_is_read_as_ever(packed):
    with EpisodeReader(packed[0]) as old, EpisodeReader(packed[1]) as new:
        assert new.cameras == sorted(CAMERAS)
        assert np.array_equal(new.episode.qpos, old.episode.qpos)
        for name, camera in old.episode.cameras.items():
            track = new.episode.cameras[name]
            assert (track.width, track.height) == (camera.width, camera.height)


def test_an_episode_whose_attributes_are_damaged_is_named(tmp_path):
    path = written(tmp_path / "a.hdf5", 2)
    content = path.read_bytes()
    path.write_bytes(content.replace(b"GCOL", b"\0\0\0\0"))  # begins what holds the texts of attributes
    with pytest.raises(DamagedFile, match=r"a\.hdf5 is damaged"):
        EpisodeReader(path)
