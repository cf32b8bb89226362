"""The world in an episode's file, from which the episode is simulated or drawn again."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from vcage.base.errors import DamagedFile
from vcage.base.geometry import Pose
from vcage.datasets.episode import DRAWN, EpisodeData
from vcage.episodes.worlds import drawn_models
from vcage.runs.context import StageContext
from vcage.schema.asset import PhysicalModel
from vcage.schema.randomisation import Drawn
from vcage.schema.robot import Robot
from vcage.schema.scene import Scene
from vcage.sim.robots import load_robot
from vcage.sim.state import WorldState
from vcage.sim.world import World


def world_facts(scene: Scene, drawn: Drawn) -> dict[str, Any]:
    """Facts of the world for a file's ``meta``.

    Args:
        scene: as simulated; the file gets it with the table top that is seen.
        drawn: for the episode.
    """
    seen = scene.model_copy(update={"table": scene.table.topped(drawn.look.table_top)})
    return {
        "robot": scene.robot,
        "scene": seen.model_dump(mode="json", by_alias=True),
        DRAWN: drawn.model_dump(mode="json"),
    }


@dataclass(frozen=True)
class Recorded:
    """An episode, and its world at the start.

    Args:
        episode: all that its file holds but pictures.
        scene, robot: of the episode.
        models: of the scene's objects, by id, with their drawn mass and friction.
        drawn: for the episode.
    """

    episode: EpisodeData
    scene: Scene
    robot: Robot
    models: Mapping[str, PhysicalModel]
    drawn: Drawn

    @classmethod
    def of(cls, episode: EpisodeData, path: Path, context: StageContext) -> Recorded:
        """Return the episode of a file.

        Args:
            episode: of the file.
            path: of the file.
            context: the library.

        Raises:
            DamagedFile: it lacks the joints of the arms, or the random draws of the episode.
            UnknownName: the library lacks an object of its scene, or there is no such robot.
        """
        scene = Scene.parse(episode.meta.get("scene"), path)
        again = "record the episode again"
        if not episode.robot_joints:
            raise DamagedFile(f"{path} does not hold the joints of the arms", hint=again, maker="collect")
        try:
            drawn = Drawn.model_validate(episode.meta.get(DRAWN))
        except ValidationError as error:
            reason = f"{path} does not say how the episode looked, and what was simulated: {error.errors()[0]['msg']}"
            raise DamagedFile(reason, hint=again, maker="collect") from error
        robot = load_robot(scene.robot)
        if untrue := next(_contradictions(episode, scene, robot, drawn), None):
            raise DamagedFile(f"{path}: {untrue}", hint=again, maker="collect")
        models = drawn_models(context.physical_models(scene), drawn.world)
        return cls(episode, scene, robot, models, drawn)

    def world(self) -> World:
        """A fresh world of the start, physics only, the arms at home."""
        return World.of_scene(self.scene, self.models, self.robot)

    def states(self) -> Iterator[WorldState]:
        """The T states."""
        e = self.episode
        for i in range(e.frames):
            poses = {name: Pose(row[i, :3], row[i, 3:]) for name, row in e.object_poses.items()}
            joints = {name: row[i] for name, row in e.robot_joints.items()}
            yield WorldState(poses, joints, {name: row[i] for name, row in e.object_joints.items()})


def _contradictions(episode: EpisodeData, scene: Scene, robot: Robot, drawn: Drawn) -> Iterator[str]:
    """Complaints about names and joints in a file that its robot, objects or cameras do not have."""
    world, objects = drawn.world, {o.id for o in scene.objects}
    if episode.meta.get("robot") != scene.robot:
        yield f"its robot is {episode.meta.get('robot')!r}, that of its scene {scene.robot!r}"
    for arm, offset in world.start.items():
        if arm not in robot.arms or len(offset) != len(robot.arms[arm].home):
            yield f"{scene.robot} has no arm {arm!r} of {len(offset)} joints"
    for what, named, known in (
        ("arm", episode.robot_joints, robot.arms),
        ("camera", drawn.look.cameras, robot.cameras),
        ("object", [*world.mass, *world.friction, *world.clutter, *world.variants, *drawn.look.tints], objects),
    ):
        for name in sorted({*named} - {*known}):
            yield f"there is no {what} {name!r} in it"
    if episode.drives is not None:
        yield from _contradictions_of_drives(episode, scene, robot)


def _contradictions_of_drives(episode: EpisodeData, scene: Scene, robot: Robot) -> Iterator[str]:
    """Complaints about drives that do not match the arms."""
    layouts = {} if episode.drives is None else episode.drives.layouts
    for name in sorted({*layouts} - {*robot.arms}):
        yield f"drives has an arm {name!r}, which {scene.robot} lacks"
    for name in sorted({*robot.arms} - {*layouts}) if layouts else ():
        yield f"drives lacks the arm {name!r} of {scene.robot}"
    for name, layout in layouts.items():
        dof = episode.robot_joints[name].shape[1] if name in episode.robot_joints else 0
        if layout.dof != dof:
            yield f"robot_joints holds {dof} joints of {name}, drives/{name}/told {layout.dof}"
        if layout.joints != (joints := len(robot.arms[name].home)):
            yield f"drives/{name}/told moves {layout.joints} joints, the arm of {scene.robot} has {joints}"
