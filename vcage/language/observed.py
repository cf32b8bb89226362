"""A recorded episode with its objects where they are at each frame, their names, and the paths of its grippers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from vcage.base.geometry import Pose
from vcage.datasets.episode import CameraTrack
from vcage.episodes.recorded import Recorded
from vcage.language.names import Names
from vcage.language.settings import SETTINGS
from vcage.runs.context import StageContext
from vcage.sim.kinematics import ArmKinematics
from vcage.sim.tints import colours_of
from vcage.tasks.scene_objects import SceneObject


@dataclass(frozen=True)
class ObservedEpisode:
    """A recorded episode and the library's models of its objects.

    Args:
        recorded: the episode.
        things: object id → object, as it stood at the start.
        kinematics: arm → its kinematics.
    """

    recorded: Recorded
    things: Mapping[str, SceneObject]
    kinematics: Mapping[str, ArmKinematics]

    @classmethod
    def of(cls, recorded: Recorded, context: StageContext) -> ObservedEpisode:
        """Return the episode with the objects of the library."""
        things = {thing.id: thing for thing in context.objects(recorded.scene)}
        return cls(recorded, things, context.kinematics(recorded.scene.robot))

    @cached_property
    def names(self) -> Names:
        """Names of the objects."""
        return Names(self.things)

    @property
    def frames(self) -> int:
        """T, the number of frames."""
        return self.recorded.episode.frames

    def at(self, frame: int) -> dict[str, SceneObject]:
        """Return object id → object, where it is at a frame."""
        return {name: self.thing_at(name, frame) for name in self.things}

    def thing_at(self, name: str, frame: int) -> SceneObject:
        """Return an object where it is at a frame."""
        episode = self.recorded.episode
        row, joints = episode.object_poses[name][frame], episode.object_joints.get(name)
        return self.things[name].moved(
            Pose(row[:3], row[3:]), None if joints is None else tuple(joints[frame].tolist())
        )

    def gripper_path(self, arm: str) -> NDArray[np.float64]:
        """(T, 3) point between the finger tips of an arm in the world, metres."""
        episode = self.recorded.episode
        columns = [i for i, name in enumerate(episode.state_names) if name.startswith(f"{arm}_joint_")]
        return np.array([self.kinematics[arm].fk(q).p for q in episode.qpos[:, columns]])

    @cached_property
    def gripper_paths(self) -> dict[str, NDArray[np.float64]]:
        """:meth:`gripper_path` of each arm."""
        return {arm: self.gripper_path(arm) for arm in self.kinematics}

    def moved_since_last(self, name: str, frame: int) -> float:
        """Return how far an object moved since the previous frame, metres."""
        path = self.recorded.episode.object_poses[name][max(0, frame - 1) : frame + 1, :3]
        return float(np.linalg.norm(path[-1] - path[0]))

    def is_left_alone(self, thing: SceneObject, frame: int) -> bool:
        """True if an object rests at a frame, and no gripper is near enough to hold it."""
        lower, upper = thing.around_boxes
        for path in self.gripper_paths.values():
            beyond = np.maximum(0, np.maximum(lower - path[frame], path[frame] - upper))
            if float(np.linalg.norm(beyond)) < SETTINGS.free_m:
                return False
        return self.moved_since_last(thing.id, frame) <= SETTINGS.still_m

    def keeps_colour(self, name: str) -> bool:
        """True if an object is drawn in a colour of the same name as the library's model of it."""
        tint = self.recorded.drawn.look.tints.get(name)
        if tint is None:
            return True
        colours = colours_of(self.recorded.models[name])
        return colours.words(tint) == colours.words()


def pixels_of(camera: CameraTrack, frame: int, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """(N, 2) column and row of (N, 3) points in the world; NaN for those behind the camera.

    The first pixel covers the square from (0, 0) to (1, 1).
    """
    local = points @ camera.extrinsics[frame, :3, :3].T + camera.extrinsics[frame, :3, 3]
    depth = np.where(local[:, 2:] > 1e-6, local[:, 2:], np.nan)
    return (local @ camera.intrinsics.T)[:, :2] / depth
