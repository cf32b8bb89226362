"""What openpi's ALOHA configuration asks of a data set, said in our own words, holds of an export of ``aloha_agilex``.

openpi loads LeRobot v2.1, looks keys up by a mapping (docs/data-formats.md, "Training with openpi"), and hands on three
pictures, a state and a window of actions, of 14 numbers each: six joints and the gripper of the left arm, then of the
right.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest

from tests.datasets.conftest import write
from tests.example_scenes import template
from tests.recordings import clip, episode
from tests.run_folders import REPOSITORY
from vcage.base.videos import decode
from vcage.datasets.lerobot.episode import LeRobotEpisode
from vcage.datasets.lerobot.statistics import picture_histogram
from vcage.sim.recording import StateLog
from vcage.sim.robots import load_robot
from vcage.sim.world import World
from vcage.tasks.assemble import episode_data
from vcage.video.codec import EncoderSettings, encode

MAPPING = {
    "images": {name: f"observation.images.{name}" for name in ("cam_high", "cam_left_wrist", "cam_right_wrist")},
    "state": "observation.state",
    "actions": "action",
    "prompt": "prompt",
}
"""Key that the policy is given → key of the data set; ``prompt`` is the text of the frame's task."""

KNOWN_CAMERAS = {"cam_high", "cam_low", "cam_left_wrist", "cam_right_wrist"}
"""Others are refused where pictures are handed on."""

HORIZON = 50
LENGTHS = (14, 9)
ARM = 7
"""Numbers of an arm: six joints, then the gripper."""


@pytest.fixture(scope="module")
def names() -> list[str]:
    """Of a state of the robot, as an episode that is simulated has them."""
    world, log = World(template().table, {}, load_robot("aloha_agilex")), StateLog(10)
    log.record(world)
    world.step()
    return episode_data(log, [], {}, {}).state_names


@pytest.fixture(scope="module")
def data_set(names: list[str], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two episodes with all cameras of the robot."""
    folder = tmp_path_factory.mktemp("openpi")
    return write("lerobot-v2.1", folder / "set", [_episode(folder, names, *one) for one in enumerate(LENGTHS)])


def _episode(folder: Path, names: list[str], index: int, length: int) -> LeRobotEpisode:
    videos, histograms = {}, {}
    for number, camera in enumerate(load_robot("aloha_agilex").cameras):
        videos[camera] = folder / f"{index}.{camera}.mp4"
        videos[camera].write_bytes(encode(clip(length, number), 10.0, EncoderSettings(), 10))
        histograms[camera] = picture_histogram(clip(length, number))
    state = np.arange(length)[:, None] / 100 + np.arange(len(names)) / 10
    grippers = [number for number, name in enumerate(names) if name.endswith("gripper")]
    state[:, grippers] = np.linspace(0, 1, length)[:, None]
    return LeRobotEpisode(
        fps=10.0,
        robot="aloha_agilex",
        task=episode().instruction,
        videos=videos,
        histograms=histograms,
        sampled=length,
        state=state,
        state_names=names,
        action=state + index,
        action_names=names,
    )


@pytest.fixture(scope="module")
def info(data_set: Path) -> dict[str, Any]:
    return json.loads((data_set / "meta/info.json").read_text())


def frame(data_set: Path, info: Mapping[str, Any], number: int, index: int) -> dict[str, Any]:
    """A frame as LeRobot's loader gives it: by key, pictures (3, H, W) from 0 to 1, the task in words."""
    at = {"episode_chunk": 0, "episode_index": number}
    row = pq.read_table(data_set / info["data_path"].format(**at)).to_pylist()[index]
    for key in (key for key, feature in info["features"].items() if feature["dtype"] == "video"):
        video = data_set / info["video_path"].format(**at, video_key=key)
        row[key] = decode(video, [index])[0].transpose(2, 0, 1) / 255
    tasks = [json.loads(line) for line in (data_set / "meta/tasks.jsonl").read_text().splitlines()]
    return row | {"prompt": next(task["task"] for task in tasks if task["task_index"] == row["task_index"])}


def repacked(found: Mapping[str, Any], mapping: Mapping[str, Any]) -> dict[str, Any]:
    """Everything that a mapping asks for, under its own names."""
    return {k: repacked(found, v) if isinstance(v, Mapping) else found[v] for k, v in mapping.items()}


def window(data_set: Path, info: Mapping[str, Any], number: int, index: int) -> tuple[np.ndarray, np.ndarray]:
    """(H, 14) actions from a frame on, ``1 / fps`` apart; (H,) whether one is beyond the end, where the last stands."""
    path = data_set / info["data_path"].format(episode_chunk=0, episode_index=number)
    table = pq.read_table(path)
    times, actions = np.array(table["timestamp"]), np.array(table["action"].to_pylist())
    wanted = times[index] + np.arange(HORIZON) / info["fps"]
    nearest = np.abs(times[None] - wanted[:, None]).argmin(axis=1)
    beyond = wanted > times[-1] + 1e-4
    assert np.abs(times[nearest] - wanted)[~beyond].max() < 1e-4
    return actions[nearest], beyond


def test_all_keys_of_the_mapping_are_found(data_set, info):
    given = repacked(frame(data_set, info, 0, 3), MAPPING)
    assert set(given["images"]) <= KNOWN_CAMERAS
    assert given["prompt"] == episode().instruction


def test_the_extra_camera_is_there_and_is_not_handed_on(data_set, info):
    assert "observation.images.front" in info["features"]
    assert "front" not in KNOWN_CAMERAS
    assert "front" not in repacked(frame(data_set, info, 0, 3), MAPPING)["images"]


def test_it_is_of_the_version_that_openpi_reads(info):
    assert (info["codebase_version"], info["robot_type"], info["fps"]) == ("v2.1", "aloha_agilex", 10)


def test_state_and_actions_are_14_numbers_left_arm_first_and_grippers_last(info, names):
    one_arm = [*(f"joint_{number}" for number in range(1, ARM)), "gripper"]
    assert names == [f"{arm}_{name}" for arm in ("left", "right") for name in one_arm]
    for key in ("observation.state", "action"):
        assert info["features"][key] == {"dtype": "float32", "shape": [2 * ARM], "names": names}


def test_joints_are_radians_within_the_robots_limits_and_grippers_open_from_0_to_1():
    robot = load_robot("aloha_agilex")
    world, log = World(template().table, {}, robot), StateLog(25)
    log.record(world)
    for opening in (1.0, 0.0):
        for arm in world.arms.values():
            arm.grip(opening)
    state = episode_data(log, [], {}, {}).qpos
    home = [joint for arm in ("left", "right") for joint in robot.arms[arm].home]
    joints, grippers = np.delete(state, [ARM - 1, 2 * ARM - 1], axis=1), state[:, [ARM - 1, 2 * ARM - 1]]
    np.testing.assert_allclose(joints, np.tile(home, (len(state), 1)), atol=0.05)
    assert np.allclose(grippers[0], 1.0, atol=0.02) and grippers[-1].max() < 0.1


def test_pictures_are_handed_on_with_their_channels_first(data_set, info):
    for picture in repacked(frame(data_set, info, 1, 2), MAPPING)["images"].values():
        assert picture.shape == (3, 48, 64)
        assert 0 <= picture.min() < picture.max() <= 1


def test_changes_of_joints_are_relative_and_those_of_grippers_are_not(data_set, info, names):
    """Columns from which ``use_delta_joint_actions`` subtracts the state: all but the seventh of each arm."""
    relative = np.array(([True] * (ARM - 1) + [False]) * 2)
    given = repacked(frame(data_set, info, 1, 2), MAPPING)
    change = np.array(given["actions"]) - np.where(relative, given["state"], 0)
    assert [name for name, whether in zip(names, relative, strict=True) if not whether] == [
        "left_gripper",
        "right_gripper",
    ]
    np.testing.assert_allclose(change[relative], 1.0, atol=1e-5)


@pytest.mark.parametrize("number", range(len(LENGTHS)))
def test_a_window_of_actions_ends_with_its_episode(data_set, info, number):
    length = LENGTHS[number]
    actions, beyond = window(data_set, info, number, 4)
    assert beyond.sum() == HORIZON - (length - 4)
    own = np.arange(4, length) / 100 + number
    np.testing.assert_allclose(actions[: length - 4, 0], own, atol=1e-5)
    np.testing.assert_allclose(actions[length - 4 :, 0], own[-1], atol=1e-5)


def test_the_page_of_data_formats_has_the_mapping_of_this_test():
    text = (REPOSITORY / "docs/data-formats.md").read_text(encoding="utf-8")
    for name, key in {**MAPPING["images"], "state": MAPPING["state"], "actions": MAPPING["actions"]}.items():
        assert f'"{name}": "{key}"' in text
