"""The pictures that a critic gets: states of a scene, drawn in the light of one episode."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from vcage.base.geometry import Pose
from vcage.episodes.close_ups import scan_cameras
from vcage.episodes.question import TOP, cameras
from vcage.schema.asset import PhysicalModel
from vcage.schema.goals import Goal
from vcage.schema.randomisation import Look
from vcage.schema.robot import Robot
from vcage.schema.scene import Scene
from vcage.sim.cameras import robot_cameras, shoot
from vcage.sim.looks import draw_look, look_world
from vcage.sim.robots import load_randomisation
from vcage.sim.state import WorldState
from vcage.tasks.scene_objects import SceneObject


def light_look(scene: Scene, models: Mapping[str, PhysicalModel], robot: Robot, rng: np.random.Generator) -> Look:
    """A look drawn from the light ranges: in it a critic sees an episode whose own look is not mild.

    Args:
        scene, models, robot: of the episode.
        rng: source of every choice.
    """
    return draw_look(load_randomisation("light").look, scene, models, robot, rng)


class Photographer:
    """Takes pictures of states of a scene.

    Args:
        scene: as it is at the start.
        models: of its objects, by id.
        robot: that stands at the table.
        look: light, table top and surroundings.
        objects: of the scene, whose bar codes and windows are looked at closely while one is scanned.

    Attributes:
        world: in which the states are drawn; nothing moves there by itself.
    """

    def __init__(
        self,
        scene: Scene,
        models: Mapping[str, PhysicalModel],
        robot: Robot,
        look: Look,
        objects: Sequence[SceneObject],
    ):
        self.world = look_world(scene, models, robot, look)
        self._scene, self._robot, self._objects = scene, robot, objects

    def shots(self, state: WorldState, goals: Sequence[Goal] = (), arm: str | None = None) -> dict[str, np.ndarray]:
        """(H, W, 3) uint8 RGB pictures by camera: those that tell some goals, wrist cameras, and of a scan close ones.

        Args:
            state: that is shown.
            goals: of the sub-task.
            arm: whose wrist camera looks on, and the others only where the moment needs them; without one all look.
        """
        self.world.set_state(state)
        wanted = arm is None or any(goal.kind.shown.moment for goal in goals)
        taken_by = cameras(self._scene, goals) if wanted else {}
        of_robot = robot_cameras(self.world)
        arms = {name: self._robot.cameras[name].arm for name in of_robot}
        taken_by |= {name: c for name, c in of_robot.items() if arms[name] and arm in (None, arms[name])}
        for goal in goals if arm is not None else ():
            if goal.kind.shown.close_up:
                taken_by |= scan_cameras(self.world, self._objects, goal.subject)
        return {name: shoot(self.world, camera) for name, camera in taken_by.items()}

    def empty_table(self) -> np.ndarray:
        """The view from above of the table with nothing on it, the robot as it is."""
        state = self.world.state()
        away = {key: Pose([0.0, 0.0, -9.0 - number]) for number, key in enumerate(state.objects)}
        picture = self.shots(WorldState(away, state.joints, state.object_joints))[TOP]
        self.world.set_state(state)
        return picture
