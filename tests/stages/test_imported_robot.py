"""A robot of RoboTwin runs once it is imported: no other file is written for it."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import pytest
import yaml

from tests.run_folders import OPTIONS, REPOSITORY
from vcage.apps.replay import replay_episode
from vcage.base.files import RunFolder
from vcage.datasets.reader import EpisodeReader
from vcage.runs.context import StageContext
from vcage.schema.episodes import Episodes
from vcage.sim.robotwin.importing import import_robot
from vcage.stages import chain

pytestmark = pytest.mark.slow

CONFIG = {
    "urdf_path": "./arm.urdf",
    "joint_stiffness": 1000,
    "joint_damping": 200,
    "ee_joints": ["joint6", "joint6"],
    "arm_joints_name": [[f"joint{number}" for number in range(1, 7)]] * 2,
    "gripper_name": [{"base": "joint7", "mimic": [["joint8", 1.0, 0.0]]}] * 2,
    "gripper_bias": 0.145,
    "gripper_scale": [0.0, 0.044],
    "homestate": [[0.0, 0.3, 0.8, -1.1, 0.0, 0.0]] * 2,
    "robot_pose": [[0, -0.417, 0.7775, 0.70710678, 0, 0, 0.70710678]],
}
"""Two single arms as RoboTwin has them, without cameras, with our own URDF in place of a download."""


def test_an_imported_robot_follows_an_instruction(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("VCAGE_DATA", str(tmp_path / "data"))
    folder = tmp_path / "embodiments" / "twin-arm"
    folder.mkdir(parents=True)
    shutil.copy(REPOSITORY / "assets/robots/aloha_agilex.urdf", folder / "arm.urdf")
    (folder / "config.yml").write_text(yaml.safe_dump(CONFIG))
    robot = import_robot(folder).name
    run, context = RunFolder(tmp_path / "run"), StageContext("offline")
    chain.run_chain(run, replace(OPTIONS, robot=robot, instruction="Put the red block on the plate"), context)
    (episode,) = [one for one in Episodes.read(run.episodes).episodes if one.accepted]
    path = run.root / str(episode.file)
    with EpisodeReader(path) as reader:
        assert (reader.episode.meta["robot"], len(reader.episode.state_names)) == ("twin-arm", 14)
    assert replay_episode(path, context).equal
