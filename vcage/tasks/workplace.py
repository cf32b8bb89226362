"""A workplace: the objects of a scene, the arms and the table that sub-tasks are examined with."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from vcage.schema.scene import Scene
from vcage.sim.kinematics import ArmKinematics, kinematics_of
from vcage.sim.robots import load_robot
from vcage.tasks.asked_arms import those_of
from vcage.tasks.ground import Ground
from vcage.tasks.scene_objects import SceneObject


@dataclass(frozen=True)
class Workplace:
    """Objects, arms and table, and the random numbers of all choices.

    Example:
        >>> workplace = Workplace.of(scene, context.objects(scene), np.random.default_rng(0))
        >>> found = find_subtasks(workplace, judge)

    Args:
        objects: of the scene, where they stand.
        kinematics: of the arms that may take part, by name.
        ground: of the table.
        rng: of all choices.
    """

    objects: Sequence[SceneObject]
    kinematics: Mapping[str, ArmKinematics]
    ground: Ground
    rng: np.random.Generator

    @classmethod
    def of(cls, scene: Scene, objects: Sequence[SceneObject], rng: np.random.Generator) -> Workplace:
        """Return the workplace of a scene with all arms of its robot.

        Args:
            scene: its robot, table and workspace count.
            objects: of the scene, where they stand.
            rng: of all choices.
        """
        kinematics = {name: kinematics_of(arm) for name, arm in load_robot(scene.robot).arms.items()}
        ground = replace(Ground.of(scene), starts={o.id: o.aabb for o in objects})
        return cls(objects, kinematics, ground, rng)

    @cached_property
    def by_id(self) -> dict[str, SceneObject]:
        """The objects by id."""
        return {o.id: o for o in self.objects}

    def others(self, *names: str) -> list[SceneObject]:
        """Return all objects but some.

        Args:
            names: ids to leave out.
        """
        return [o for o in self.objects if o.id not in names]

    def with_objects(self, objects: Sequence[SceneObject]) -> Workplace:
        """Return the same workplace with other objects, or with objects at other places."""
        return replace(self, objects=objects)

    def without_arms(self, arms: Collection[str]) -> Workplace:
        """Return the same workplace without some arms."""
        return replace(self, kinematics={name: arm for name, arm in self.kinematics.items() if name not in arms})

    def with_arms(self, arm: str | None, hand_to: str | None = None) -> Workplace:
        """Return the same workplace with the arms that may take part in a sub-task.

        Args:
            arm: the arm that must do it; None for any.
            hand_to: the arm that it hands to.
        """
        return replace(self, kinematics=those_of(self.kinematics, arm, hand_to))
