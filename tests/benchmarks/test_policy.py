"""The training data of the policy benchmark, on made-up demonstrations."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
import torch

from benchmarks import policy
from benchmarks._policy import demonstrations
from benchmarks._policy.demonstrations import ENCODINGS, Demonstrations, View
from benchmarks._policy.network import Size
from benchmarks._policy.rollouts import EXECUTED, Outcome, Rollouts, command
from benchmarks._policy.training import Policy, Scale, Settings, errors, train, trained
from tests.run_folders import Finished
from vcage.base.files import RunFolder, read_json
from vcage.datasets.reader import EpisodeReader
from vcage.runs.accepted import accepted_episodes
from vcage.schema.episodes import Episode
from vcage.video.codec import EncoderSettings, encode

SETTINGS = Settings(steps=50, batch=16, rate=3e-3, size=Size(chunk=4, width=16, heads=2, layers=1))


def toy(episodes: int = 16, frames: int = 5, seed: int = 0) -> Demonstrations:
    """A bright square somewhere in each episode; the two actions say where it is, the second is a gripper's."""
    rng = np.random.default_rng(seed)
    places = np.repeat(rng.integers(0, 25, (episodes, 2)), frames, axis=0)
    pictures = np.zeros((len(places), 1, 32, 32, 3), np.uint8)
    for picture, (row, column) in zip(pictures, places, strict=True):
        picture[0, row : row + 8, column : column + 8] = 255
    wanted = (places / 24).astype(np.float32)
    ends = frames * np.arange(1, episodes + 1)
    return Demonstrations(pictures, np.zeros_like(wanted), wanted, ends, (1,), pictures.nbytes)


def weights(made: Policy) -> torch.Tensor:
    return torch.cat([parameter.detach().flatten() for parameter in made.network.parameters()])


# --- training ------------------------------------------------------------------------------------------


def test_a_policy_learns_from_pictures() -> None:
    losses: list[float] = []
    made = Policy(toy(), SETTINGS.size, 0)
    before = errors(made, toy())
    train(made, toy(), SETTINGS, 0, lambda _, loss: losses.append(loss))
    assert np.mean(losses[-10:]) < 0.7 * np.mean(losses[:5])
    assert errors(made, toy())["error_rad"] < before["error_rad"]


def test_the_same_seed_gives_the_same_weights_and_another_one_others() -> None:
    made = [Policy(toy(), SETTINGS.size, seed) for seed in (1, 1, 2)]
    for one, seed in zip(made, (1, 1, 2), strict=True):
        train(one, toy(), Settings(steps=3, batch=8, size=SETTINGS.size), seed)
    first, again, other = map(weights, made)
    assert torch.equal(first, again) and not torch.equal(first, other)


def test_a_trained_policy_is_not_trained_again(tmp_path: Path) -> None:
    few = Settings(steps=3, batch=8, size=SETTINGS.size)
    first = trained(toy(), few, 0, "toy", tmp_path / "weights.pt")
    (tmp_path / "weights.pt").touch()
    again = trained(toy(), Settings(steps=10**9, size=SETTINGS.size), 0, "toy", tmp_path / "weights.pt")
    assert torch.equal(weights(first), weights(again))


def test_normalised_numbers_come_back_unchanged() -> None:
    numbers = np.random.default_rng(0).normal(3, 5, (50, 4)).astype(np.float32)
    numbers[:, 2] = 1.25  # an arm that does not move
    scale = Scale.of(numbers)
    normal = scale.normalised(torch.from_numpy(numbers))
    assert torch.allclose(scale.restored(normal), torch.from_numpy(numbers), atol=1e-4)
    assert normal.std(dim=0)[[0, 1, 3]].numpy() == pytest.approx(1, abs=0.05) and not normal[:, 2].any()


# --- demonstrations ------------------------------------------------------------------------------------


def test_a_chunk_stops_at_the_end_of_its_episode() -> None:
    made = toy(episodes=2, frames=5)
    made.actions[:, 0] = np.arange(10)
    actions, valid = made.chunk(np.array([0, 3, 4, 5]), 4)
    assert valid.sum(axis=1).tolist() == [4, 2, 1, 4]
    assert np.array_equal(actions[1], made.actions[[3, 4, 4, 4]])
    assert np.array_equal(actions[3], made.actions[5:9])


def test_padding_after_the_end_of_an_episode_adds_no_loss() -> None:
    made = toy(episodes=1, frames=3)
    made.actions[:, 0] = [3, 7, 13]
    one = Policy(made, SETTINGS.size, 0)
    given = one.act(made.pictures, made.states)
    wanted = [np.abs(given[i, : 3 - i, 0] - made.actions[i:, 0]) for i in range(3)]
    assert errors(one, made)["error_rad"] == pytest.approx(np.concatenate(wanted).mean(), rel=1e-5)


def test_every_encoding_gives_pictures_of_the_same_shape(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pictures = np.random.default_rng(0).integers(0, 256, (6, 48, 64, 3), np.uint8)
    shown = pictures // 8 + 100  # mild, so that what comes back is near
    monkeypatch.setattr(demonstrations, "_raw", lambda *_: (shown, 10.0))
    video = tmp_path / "ours.mp4"
    video.write_bytes(encode(shown, 10, EncoderSettings(), 10))
    monkeypatch.setattr(demonstrations, "_videos", lambda _: {("episodes/one.hdf5", "cam"): video})
    view, episode = View(("cam",), 24, 32), Episode.model_construct(file="episodes/one.hdf5")
    for encoding in ENCODINGS:
        path = tmp_path / f"{encoding}.npy"
        demonstrations._make(RunFolder(tmp_path), [episode], encoding, view, path)
        kept = np.load(path)
        assert kept.shape == (6, 1, 24, 32, 3) and kept.dtype == np.uint8
        assert np.abs(kept.astype(int) - 115).mean() < 16 and read_json(path.with_suffix(".json"))["bytes"] > 0


# --- rollouts and figures ------------------------------------------------------------------------------


@pytest.mark.slow
def test_recorded_actions_do_the_task_again_and_an_arm_that_waits_does_not(finished: Finished) -> None:
    rollouts = Rollouts(finished.run, 1, View(("cam_high",), 24, 32))
    assert rollouts.replayed(0)
    waited = rollouts.outcome(_Waits(), 0)  # pyrefly: ignore[bad-argument-type]
    assert waited == Outcome(touched=False, lifted=False, done=False)


@pytest.mark.slow
def test_a_rollout_tells_how_far_it_came(finished: Finished) -> None:
    rollouts = Rollouts(finished.run, 1, View(("cam_high",), 24, 32))
    with EpisodeReader(finished.run.root / str(accepted_episodes(finished.run)[0].file)) as reader:
        actions, grippers = reader.episode.action.astype(np.float32), list(reader.episode.grippers)
    done = rollouts.outcome(_Repeats(actions), 0)  # pyrefly: ignore[bad-argument-type]
    assert done == Outcome(touched=True, lifted=True, done=True)
    actions[:, grippers] = 1.0
    open_hands = rollouts.outcome(_Repeats(actions), 0)  # pyrefly: ignore[bad-argument-type]
    assert not open_hands.lifted and not open_hands.done


class _Repeats:
    """Repeats the recorded actions regardless of its input."""

    def __init__(self, actions: np.ndarray):
        self._left = actions

    def act(self, pictures: np.ndarray, states: np.ndarray) -> np.ndarray:
        chunk = self._left[: EXECUTED + 1]
        self._left = self._left[min(EXECUTED, len(self._left) - 1) :]
        return chunk[None]


class _Waits:
    """Stays where it is."""

    def act(self, pictures: np.ndarray, states: np.ndarray) -> np.ndarray:
        assert pictures.shape == (1, 1, 24, 32, 3)
        return np.repeat(states[:, None], 8, axis=1)


class _Arm:
    """Records its calls."""

    def __init__(self, joints: int):
        self.qpos = np.zeros(joints + 1)
        self.told: list[object] = []

    def command_joints(self, q: Sequence[float], velocity: Sequence[float]) -> None:
        self.told += [list(q), list(velocity)]

    def command_gripper(self, opening: float) -> None:
        self.told.append(opening)


def test_each_arm_gets_its_part_of_an_action_and_fingers_stay_in_range() -> None:
    arms = {"left": _Arm(1), "right": _Arm(2)}
    command(arms, np.array([1, 1.2, 3, 4, -0.1], np.float32), np.arange(5, dtype=np.float32))  # pyrefly: ignore
    assert arms["left"].told == [[1], [0], 1.0]
    assert arms["right"].told == [[3, 4], [2, 3], 0.0]


def test_the_interval_of_a_mean_is_students() -> None:
    low, high = policy.interval([1.0, 2.0, 3.0])  # t = 4.303 with two degrees of freedom
    assert (low, high) == pytest.approx((2 - 4.303 / 3**0.5, 2 + 4.303 / 3**0.5), abs=1e-3)


def test_rows_are_compared_seed_by_seed() -> None:
    found = {"raw/varied": [0.1, 0.3], "ours/varied": [0.11, 0.31], "lerobot/varied": [0.0, 0.4]}
    told = policy.differences({**found, "raw/fixed": [0.2, 0.4]})
    assert told["ours/varied - raw/varied"] == {"mean": 0.01, "low": 0.01, "high": 0.01, "within": False}
    assert told["lerobot/varied - raw/varied"]["within"]
