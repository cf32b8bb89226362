"""Episodes that the scripts play for the policy benchmark, and the sub-tasks of their frames."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from benchmarks._policy import played
from benchmarks._policy.demonstrations import _steps
from vcage.base.errors import TooFewVerified
from vcage.base.files import RunFolder


def kept_episode(folder: Path, number: int, success: bool, frames: int = 3) -> None:
    """An episode that was played before; its states are its number."""
    folder.mkdir(exist_ok=True)
    rows = dict.fromkeys(("states", "objects", "actions", "steps"), np.full((frames, 1), number))
    np.savez(folder / f"{number:06d}.npz", success=success, **rows)


def numbers_of(episodes: list[played.Played]) -> list[int]:
    return [int(episode.states[0, 0]) for episode in episodes]


@pytest.fixture
def joined(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(played, "joined", lambda run, episodes, context: numbers_of(episodes))


def test_episodes_that_the_folder_holds_are_not_played_again(tmp_path: Path) -> None:
    for number, frames in enumerate((3, 0, 2)):
        kept_episode(tmp_path / "played", number, success=True, frames=frames)
    found = played.played(RunFolder(tmp_path / "none"), range(3), tmp_path / "played")
    assert numbers_of(found) == [0, 2]  # the second has no start


@pytest.mark.parametrize(("verified", "wanted"), [(False, [0, 1, 2]), (True, [0, 2, 3])])
def test_the_next_episodes_take_the_places_of_failures_that_are_left_out(
    joined: None, tmp_path: Path, verified: bool, wanted: list[int]
) -> None:
    for number in range(4):
        kept_episode(tmp_path / "played", number, success=number != 1)
    assert played.demonstrations(RunFolder(tmp_path), 3, verified, tmp_path / "played") == wanted


def test_a_task_that_hardly_ever_succeeds_is_refused(joined: None, tmp_path: Path) -> None:
    for number in range(14):
        kept_episode(tmp_path / "played", number, success=number == 13)
    with pytest.raises(TooFewVerified, match="of 14 episodes that were played, 1 can be used"):
        played.demonstrations(RunFolder(tmp_path), 2, True, tmp_path / "played")


def test_the_last_episode_that_may_be_played_counts(joined: None, tmp_path: Path) -> None:
    for number in range(8):
        kept_episode(tmp_path / "played", number, success=number == 6)
    assert played.demonstrations(RunFolder(tmp_path), 1, True, tmp_path / "played") == [6]


def test_the_longest_of_the_first_episodes_that_succeeds_says_how_long_a_policy_may_take(tmp_path: Path) -> None:
    for number, (frames, success) in enumerate([(5, True), (9, False), (6, True), (8, True)]):
        kept_episode(tmp_path / "played", number, success, frames)
    assert played.longest_success(RunFolder(tmp_path), 3, tmp_path / "played") == 6
    with pytest.raises(TooFewVerified, match="of 0 episodes that were played, none succeeds"):
        played.longest_success(RunFolder(tmp_path), 0, tmp_path / "played")


def test_sub_tasks_count_from_the_beginning_of_each_episode() -> None:
    subtasks, episodes = np.array([4, 4, 5, 4, 7, 7, 5]), np.array([0, 0, 0, 1, 1, 1, 2])
    assert _steps(subtasks, episodes).tolist() == [0, 0, 1, 0, 1, 1, 0]
