"""Which clips the compression benchmark has, and which of their frames are scored."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchmarks import _compression_clips
from benchmarks._compression_clips import HIGH, RIGHT, UNSEEN, Clip, clips
from benchmarks._compression_episodes import RECIPES, SIZE, sharp
from benchmarks._compression_noise import RealCamera
from tests import recordings
from vcage.datasets.hdf5 import write_episode
from vcage.sim.robots import load_robot
from vcage.video.search import held_out_frames


@pytest.fixture
def recorded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> np.ndarray:
    """The pictures of RIGHT in an episode that stands for every recipe's."""
    path = write_episode(tmp_path / "episode.hdf5", recordings.episode(30), recordings.pictures(30))
    monkeypatch.setattr(_compression_clips, "episode_path", lambda _recipe: path)
    return recordings.clip(30, recordings.CAMERAS.index(RIGHT))


@given(st.integers(1, 400), st.sets(st.integers(0, 399)))
def test_at_most_one_of_every_ten_frames_is_held_out_and_none_that_was_seen(count: int, seen: set[int]) -> None:
    frames = held_out_frames(count, sorted(seen), UNSEEN)
    assert len({i // 10 for i in frames}) == len(frames)
    assert all(0 <= i < count and i not in seen for i in frames)


@pytest.mark.parametrize("gop", [2, 5, 10])
def test_held_out_frames_stand_at_all_places_of_a_group(gop: int) -> None:
    assert {i % gop for i in held_out_frames(120, [], UNSEEN)} == set(range(gop))


def test_there_is_a_rendered_clip_of_each_of_twelve_episodes() -> None:
    rendered = [clip for clip in clips(quick=False) if clip.kind == "rendered"]
    assert [clip.recipe for clip in rendered] == list(RECIPES)
    assert len(RECIPES) == 12 and len({recipe.instruction for recipe in RECIPES}) >= 3


@pytest.mark.parametrize("kind", ["rendered", "noisy"])
def test_cameras_of_each_kind_stand_and_move(kind: str) -> None:
    moving = {clip.camera != HIGH for clip in clips(quick=False) if clip.kind == kind}
    assert moving == {True, False}


def test_clips_have_names_of_their_own() -> None:
    names = [clip.name for quick in (True, False) for clip in clips(quick)]
    assert len(set(names)) == len(names)


def test_quick_takes_the_beginnings_of_two_episodes() -> None:
    quick = clips(quick=True)
    assert len({clip.recipe for clip in quick}) == len(quick) == 2
    assert all(clip.length for clip in quick)


def test_a_rendered_clip_matches_the_episode(recorded: np.ndarray) -> None:
    film = Clip(RECIPES[0], RIGHT).load()
    np.testing.assert_array_equal(film.frames, recorded)
    assert film.fps == recordings.FPS


def test_a_short_clip_has_keyframes_of_its_own(recorded: np.ndarray) -> None:
    film = Clip(RECIPES[0], RIGHT, length=12).load()
    np.testing.assert_array_equal(film.frames, recorded[:12])
    assert film.keyframes[-1] == 11


def test_a_noisy_clip_is_the_rendered_one_seen_by_a_real_camera(recorded: np.ndarray) -> None:
    camera = RealCamera(6000.0)
    film = Clip(RECIPES[0], RIGHT, camera).load()
    np.testing.assert_array_equal(film.frames, camera.film(recorded))


def test_episodes_are_drawn_in_the_size_of_real_cameras() -> None:
    robot = load_robot("dual_panda")
    assert {(camera.width, camera.height) for camera in sharp(robot).cameras.values()} == {SIZE}
    assert sharp(robot).arms == robot.arms
