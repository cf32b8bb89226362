"""A run as an environment: spaces, seeds, recorded starts, and what an episode says."""

from __future__ import annotations

import subprocess
import sys
from contextlib import closing
from functools import partial
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import psutil
import pyarrow.parquet as pq
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AsyncVectorEnv

from tests.run_folders import FPS, Finished, copied
from vcage.base.errors import MissingStage, UnknownName, UsageError
from vcage.base.reading import read_json
from vcage.datasets.reader import EpisodeReader
from vcage.evaluation.environment import RunEnv, make_env
from vcage.stages import export


@pytest.fixture(scope="module")
def env(finished: Finished) -> RunEnv:
    return make_env(finished.run.root, finished.context, pictures=False, environment_state=True)


def equal(one: dict[str, Any], other: dict[str, Any]) -> bool:
    return one.keys() == other.keys() and all(np.array_equal(one[name], other[name]) for name in one)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::UserWarning")
def test_gymnasium_finds_no_fault_with_it_nor_with_its_pictures(finished: Finished) -> None:
    made = gymnasium.make("vcage.evaluation.gymnasium_ids:vcage/Run-v0", run=finished.run.root, cameras=("cam_high",))
    seen, _ = made.reset(seed=1)
    assert seen["pixels"]["cam_high"].std() > 10
    assert made.spec is not None and made.unwrapped.metadata["render_fps"] == FPS
    check_env(made.unwrapped)


@pytest.mark.parametrize(
    ("imports", "name"),
    [
        ("import gymnasium, vcage", "vcage/Run-v0"),
        ("import vcage, gymnasium", "vcage.evaluation.gymnasium_ids:vcage/Run-v0"),
    ],
)
def test_gymnasium_knows_it_by_name_in_a_new_process(imports: str, name: str, tmp_path: Path) -> None:
    code = f"{imports}; gymnasium.make({name!r}, run={str(tmp_path / 'none')!r})"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert "MissingStage" in done.stderr and "NamespaceNotFound" not in done.stderr


@pytest.mark.slow
def test_many_act_side_by_side_as_each_does_alone(finished: Finished, env: RunEnv) -> None:
    one = partial(make_env, finished.run.root, pictures=False, environment_state=True)
    with closing(AsyncVectorEnv([one, one])) as many:
        seen, _ = many.reset(seed=[5, 6])
        moved, *_, info = many.step(seen["agent_pos"] + 0.05)
    alone, _ = env.reset(seed=6)
    assert np.array_equal(seen["environment_state"][1], alone["environment_state"])
    assert seen["instruction"][1] == alone["instruction"]
    assert np.array_equal(moved["agent_pos"][1], env.step(alone["agent_pos"] + 0.05)[0]["agent_pos"])
    assert info["is_success"].tolist() == [False, False]


def test_a_seed_gives_the_same_episode_whatever_happened_before(env: RunEnv) -> None:
    first, _ = env.reset(seed=3)
    moved = [env.step(first["agent_pos"] + 0.05)[0] for _ in range(3)]
    other, _ = env.reset(seed=4)
    again, _ = env.reset(seed=3)
    assert equal(first, again) and not equal(first, other)
    assert all(map(equal, moved, [env.step(first["agent_pos"] + 0.05)[0] for _ in range(3)]))


def test_starts_are_none_that_collecting_draws(finished: Finished, env: RunEnv) -> None:
    with EpisodeReader(finished.run.root / "episodes" / "episode_000000.hdf5") as reader:
        collected = {name: poses[0, :3] for name, poses in reader.episode.object_poses.items()}
    for seed in range(2):
        env.reset(seed=seed)
        assert env._episode is not None
        assert not any(np.allclose(env._episode.world.object_pose(n).p, p, atol=1e-3) for n, p in collected.items())


def test_recorded_actions_do_the_task_again_in_the_recorded_states(finished: Finished, env: RunEnv) -> None:
    with EpisodeReader(finished.run.root / "episodes" / "episode_000000.hdf5") as reader:
        episode = reader.episode
    seen, info = env.reset(options={"episode": 0})
    states, done = [seen["agent_pos"]], False
    assert not info["success"] and not info["touched"]
    for action in episode.action:
        seen, reward, done, late, info = env.step(action)
        states.append(seen["agent_pos"])
        assert reward == float(done) and not late
        if done:
            break
    assert info["success"] and info["is_success"] and all(info["goals"].values())
    assert set(info["lifted"]) == set(info["touched"]) and len(info["lifted"]) == 2
    assert info["seconds"] == pytest.approx((len(states) - 1) / FPS)
    joints = [not name.endswith("gripper") for name in env.joint_names]
    away = np.abs(np.array(states)[: episode.frames] - episode.qpos[: len(states)])[:, joints]
    *others, worst = sorted(away.max(axis=1))  # radians, at 5 frames a second, between which actions are straight lines
    assert max(others) < 0.01 and worst < 0.04


def test_the_state_of_objects_is_named(env: RunEnv) -> None:
    seen, _ = env.reset(seed=0)
    assert env._episode is not None
    names, values = env.state_layout.names, seen["environment_state"]
    assert len(names) == len(set(names)) == len(values) == env.observation_space["environment_state"].shape[0]
    name = next(iter(env.state_layout.objects))
    at = [values[names.index(f"{name}.{axis}")] for axis in "xyz"]
    assert at == pytest.approx(env._episode.world.object_pose(name).p, abs=1e-6)


def test_an_export_for_training_on_states_has_what_is_observed(finished: Finished, env: RunEnv, tmp_path: Path) -> None:
    run = copied(finished.run, tmp_path, before="compress")
    options = export.Options(formats=("lerobot-v3.0",), no_videos=True, environment_state=True)
    export.execute(run, options, finished.context)
    features = read_json(run.root / "export/lerobot-v3.0/meta/info.json")["features"]
    assert features["observation.environment_state"]["names"] == env.state_layout.names
    assert features["observation.state"]["names"] == features["action"]["names"] == env.joint_names
    assert not [name for name in features if name.startswith("observation.images")]
    rows = pq.read_table(run.root / "export/lerobot-v3.0/data/chunk-000/file-000.parquet").to_pylist()
    seen, _ = env.reset(options={"episode": 0})
    assert np.array_equal(rows[0]["observation.environment_state"], seen["environment_state"])
    assert np.array_equal(rows[0]["observation.state"], seen["agent_pos"])


def test_an_episode_ends_when_it_has_lasted_too_long(finished: Finished) -> None:
    short = make_env(finished.run.root, finished.context, pictures=False, max_steps=np.int64(2))
    seen, _ = short.reset(seed=0)
    ends = [short.step(seen["agent_pos"])[2:4] for _ in range(2)]
    assert ends == [(False, False), (False, True)]


@pytest.mark.parametrize(
    ("action", "complaint"),
    [
        (np.zeros(3), r"shape \(3,\)"),
        (np.full(14, np.nan), "NaN or infinity for left_joint_1"),
        (np.full(14, 1j), "complex128"),
        ("go", "<U2"),
    ],
)
def test_an_action_that_is_none_is_refused(env: RunEnv, action: np.ndarray, complaint: str) -> None:
    env.reset(seed=0)
    with pytest.raises(UsageError, match=complaint):
        env.step(action)


@pytest.mark.parametrize(
    ("options", "complaint"),
    [
        ({"layout": "bogus"}, "layout='bogus': Input should be 'varied' or 'fixed'"),
        ({"max_steps": 0}, "max_steps=0: Input should be greater than 0"),
        ({"max_steps": 1.5}, "max_steps=1.5"),
        ({"environment_state": "yes"}, "environment_state='yes'"),
        ({"vary": "bogus"}, "vary='bogus'"),
        ({"cameras": "front"}, "cameras='front'"),
        ({"foo": 1}, "foo=1"),
    ],
)
def test_an_option_that_is_none_is_refused_with_those_that_are(options: dict[str, Any], complaint: str) -> None:
    with pytest.raises(UsageError, match=complaint) as caught:
        make_env("anywhere", **options)
    assert "max_steps, randomise" in str(caught.value.hint)


def test_an_unknown_option_of_reset_is_refused(env: RunEnv) -> None:
    with pytest.raises(UnknownName, match="epsode"):
        env.reset(options={"epsode": 0})


@pytest.mark.slow
def test_resets_take_no_more_and_more_memory(env: RunEnv) -> None:
    held = []
    for seed in range(12):
        env.reset(seed=seed)
        held.append(psutil.Process().memory_info().rss / 1e6)
    assert held[-1] - held[4] < 3  # megabytes; without forgetting, 0.7 for each


def test_without_pictures_nothing_is_drawn(finished: Finished, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sapien.render.RenderSystem", None)
    monkeypatch.setattr("vcage.evaluation.acting.look_world", None)
    blind = make_env(finished.run.root, finished.context, pictures=False)
    seen, _ = blind.reset(seed=2)
    assert "pixels" not in seen and "pixels" not in blind.step(seen["agent_pos"])[0]


def test_before_a_reset_there_is_nothing_to_act_in(finished: Finished) -> None:
    with pytest.raises(UsageError, match="no episode has begun"):
        make_env(finished.run.root, finished.context, pictures=False).step(np.zeros(14))


def test_what_a_run_lacks_is_named(finished: Finished, tmp_path) -> None:
    with pytest.raises(UnknownName, match="cam_low"):
        make_env(finished.run.root, finished.context, cameras=("cam_low",))
    with pytest.raises(UnknownName, match="chain"):
        make_env(finished.run.root, finished.context, chain=7)
    run = copied(finished.run, tmp_path, before="collect")
    with pytest.raises(MissingStage, match="no accepted episode") as found:
        make_env(run.root, finished.context, pictures=False)
    assert "--max-steps" in found.value.hint
    assert make_env(run.root, finished.context, pictures=False, max_steps=5).reset(seed=0)
