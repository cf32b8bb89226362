from __future__ import annotations

import os
import shutil
from pathlib import Path

import numpy as np
import pytest

from tests.datasets.packed_files import pack
from tests.recordings import CAMERAS, written
from vcage.base.errors import DamagedFile
from vcage.datasets.reader import EpisodeReader


@pytest.fixture(scope="module")
def packed(tmp_path_factory):
    """An episode and the same with its pictures in videos."""
    folder = tmp_path_factory.mktemp("reader")
    source = written(folder / "episode.hdf5", 6)
    return source, pack(source, folder / "small/episode.hdf5")


def test_pictures_that_lie_in_a_video_are_read_from_it(packed):
    with EpisodeReader(packed[1]) as reader:
        images = reader.images(reader.cameras[0])
        every = np.stack(list(images))
        assert every.shape == images.shape
        assert np.array_equal(images[1:4], every[1:4])
        assert np.array_equal(images[2], every[2])


def test_a_vanished_video_is_named(packed, tmp_path):
    alone = shutil.copyfile(packed[1], tmp_path / "alone.hdf5")
    with EpisodeReader(alone) as reader, pytest.raises(DamagedFile, match="which is not there"):
        reader.images(reader.cameras[0])


def test_a_pipe_in_place_of_an_episode_or_its_video_is_refused(packed, tmp_path):
    alone = shutil.copyfile(packed[1], tmp_path / "alone.hdf5")
    with EpisodeReader(alone) as reader, pytest.raises(DamagedFile, match="which is not there") as gone:
        reader.images(reader.cameras[0])
    video = next(word for word in gone.value.message.split() if ".mp4" in word).strip(",")
    os.mkfifo(video)
    with EpisodeReader(alone) as reader, pytest.raises(DamagedFile, match=r"\.mp4 is no regular file"):
        reader.images(reader.cameras[0])
    with pytest.raises(DamagedFile, match=r"\.mp4 is no regular file"):
        EpisodeReader(Path(video))


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
