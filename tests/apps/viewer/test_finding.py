from __future__ import annotations

import h5py
import pytest

from tests.datasets.recordings.layouts import DEMOS, act, robomimic, robotwin
from tests.recordings import CAMERAS, FPS, HEIGHT, WIDTH, clip, collected, written
from vcage.apps.viewer.show import choose, find_episodes, view
from vcage.base.errors import DamagedFile, InputFileError, MissingStage, SchemaMismatch, UnknownName
from vcage.datasets.packed import write_packed
from vcage.datasets.picture_links import Stream
from vcage.video.codec import EncoderSettings, encode


def test_a_run_folder_offers_its_episodes_by_their_numbers(tmp_path):
    run = collected(tmp_path / "run")
    found = find_episodes(run.root)
    assert {number: path.name for number, path in found.items()} == {
        0: "episode_000000.hdf5",
        1: "episode_000001.hdf5",
    }
    assert find_episodes(run.episodes.parent) == found


def test_a_folder_of_files_offers_them_by_name(tmp_path):
    robotwin(tmp_path / "a.hdf5")
    act(tmp_path / "b.hdf5")
    written(tmp_path / "c.hdf5", 2)
    found = find_episodes(tmp_path)
    assert [found[0].LAYOUT, found[1].LAYOUT, found[2]] == ["robotwin", "act", tmp_path / "c.hdf5"]


def test_a_file_of_demonstrations_offers_them_by_their_place(tmp_path):
    found = find_episodes(robomimic(tmp_path / "lift.hdf5"))
    assert [found[place].part for place in range(3)] == [*DEMOS]


def test_an_episode_with_pictures_in_videos_is_a_recording(tmp_path):
    whole, streams = written(tmp_path / "whole.hdf5", 4), []
    for camera in CAMERAS:
        (tmp_path / f"{camera}.mp4").write_bytes(encode(clip(4), FPS, EncoderSettings(), 20))
        key = f"observations/images/{camera}"
        streams.append(Stream(camera, key, f"{camera}.mp4", 4, WIDTH, HEIGHT, "raw", False))
    packed = write_packed(whole, tmp_path / "packed.hdf5", streams)
    assert find_episodes(packed)[0].LAYOUT == "vcage"
    shown = view(packed, save=tmp_path / "look.rrd")
    assert (shown.contents.frames, list(shown.contents.cameras)) == (4, list(CAMERAS))


def test_the_first_is_the_default_and_others_are_listed(tmp_path):
    found = {2: tmp_path, 5: tmp_path}
    assert (choose(found, None, tmp_path), choose(found, 5, tmp_path)) == (2, 5)
    with pytest.raises(UnknownName, match="available: 2, 5"):
        choose(found, 0, tmp_path)


def test_a_run_without_episodes_says_so(tmp_path):
    with pytest.raises(MissingStage, match="holds no episode"):
        choose(find_episodes(collected(tmp_path / "run", count=0).root), None, tmp_path)


@pytest.mark.parametrize("name", ["missing.hdf5", "missing"])
def test_a_missing_episode_is_named(tmp_path, name):
    with pytest.raises(InputFileError, match=name):
        find_episodes(tmp_path / name)


def test_a_file_that_is_cut_off_is_damaged(tmp_path):
    path = written(tmp_path / "episode.hdf5", 2)
    path.write_bytes(path.read_bytes()[:1000])
    with pytest.raises(DamagedFile, match=r"episode\.hdf5"):
        find_episodes(path)


def test_an_episode_of_another_version_is_not_taken_for_one_of_others(tmp_path):
    path = written(tmp_path / "episode.hdf5", 2)
    with h5py.File(path, "r+") as file:
        file.attrs["schema"] = "vcage.episode/0"
    with pytest.raises(SchemaMismatch, match=r"vcage\.episode/0"):
        view(path, save=tmp_path / "look.rrd")
    assert not (tmp_path / "look.rrd").exists()
