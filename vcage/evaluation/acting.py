"""An episode in which a policy acts: actions carried out, observations taken, and what was attained."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vcage.datasets.environment_state import StateLayout
from vcage.evaluation.attained import Attained, Task
from vcage.evaluation.episode_start import EpisodeStart
from vcage.evaluation.observation import agent_pos
from vcage.sim.looks import look_world
from vcage.sim.replay import render_state
from vcage.sim.robots import load_robot
from vcage.sim.world import PHYSICS_HZ, World
from vcage.tasks.setting import begin
from vcage.tasks.state import LOOK_EVERY_STEPS


@dataclass
class Acting:
    """An episode under way: a world that moves, and a second one in which it is drawn, as recordings are.

    Args:
        start: of the episode.
        task: what is to be attained.
        fps: actions per second of simulated time.
        cameras: whose pictures are observed; none are drawn if empty.
        state: layout of the observed state of objects; None if it is not observed.

    Attributes:
        world: that moves.
        attained: until now.
        actions: that were carried out.
    """

    start: EpisodeStart
    task: Task
    fps: int
    cameras: Sequence[str] = ()
    state: StateLayout | None = None
    actions: int = 0
    _drawer: World | None = None

    def __post_init__(self) -> None:
        scene, models = self.start.scene, self.start.models
        robot = load_robot(scene.robot)
        self.world = World.of_scene(scene, models, robot)
        begin(self.world, self.start.drawn.world.start)
        if self.cameras:
            self._drawer = look_world(scene, models, robot, self.start.drawn.look)
        self.attained = Attained(self.world, self.start.objects, self.task)
        self._begun = self.world.steps
        self._target = np.concatenate([self.world.arms[name].command for name in sorted(self.world.arms)])

    def carry_out(self, action: NDArray[np.float64]) -> None:
        """Drive from the present targets to the next, in a straight line."""
        steps = PHYSICS_HZ // self.fps
        rate = (action - self._target) * self.fps
        for step in range(steps):
            _command(self.world, self._target + (action - self._target) * (step / steps), rate)
            self.world.step()
            if self.world.steps % LOOK_EVERY_STEPS == 0:
                self.attained.look()
        self._target = action
        self.attained.judge()
        self.actions += 1

    def observation(self) -> dict[str, Any]:
        """The present observation."""
        seen: dict[str, Any] = {"agent_pos": agent_pos(self.world), "instruction": self.start.sentence}
        if self.state is not None:
            poses, joints = self.world.object_poses(), self.world.joints_of_objects()
            seen["environment_state"] = self.state.values(poses, joints)
        if self._drawer is not None:
            seen["pixels"] = render_state(self._drawer, self.world.state(), self.cameras).pictures
        return seen

    def info(self) -> dict[str, Any]:
        """Facts about the episode."""
        attained = self.attained
        return {
            "success": attained.success,
            "is_success": attained.success,
            "goals": dict(attained.goals),
            "touched": sorted(attained.touched),
            "lifted": sorted(attained.lifted),
            "brushed": sorted(attained.brushed),
            "collisions": sorted(attained.collisions),
            "seconds": (self.world.steps - self._begun) / PHYSICS_HZ,
            "start": dict(self.start.origin),
        }


def _command(world: World, target: NDArray[np.float64], rate: NDArray[np.float64]) -> None:
    """Give every arm its part of a target (D,), passing at a rate per second."""
    first = 0
    for name in sorted(world.arms):
        arm = world.arms[name]
        last = first + len(arm.joints)
        arm.command_joints(target[first:last], rate[first:last])
        arm.command_gripper(float(target[last]))
        first = last + 1
