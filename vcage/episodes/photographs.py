"""The pictures that a critic gets: states of a scene, drawn in the light of one episode.

A scan is shown close up: the bar code and the scanner's window face each other, so each needs its own picture.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from vcage.base.geometry import Camera, Pose, look_at
from vcage.episodes.question import cameras
from vcage.schema.asset import Face, PhysicalModel
from vcage.schema.goals import Goal
from vcage.schema.randomisation import Look
from vcage.schema.robot import Robot
from vcage.schema.scene import Scene
from vcage.sim.cameras import observe, robot_cameras, shoot
from vcage.sim.looks import draw_look, look_world
from vcage.sim.robots import load_randomisation
from vcage.sim.state import WorldState
from vcage.sim.world import World
from vcage.tasks.scene_objects import SceneObject


def light_look(scene: Scene, models: Mapping[str, PhysicalModel], robot: Robot, rng: np.random.Generator) -> Look:
    """A look drawn from the light ranges: the critic sees an episode in it whose own look is not mild.

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
        objects: of the scene; bar codes and windows are photographed closely during a scan.

    Attributes:
        world: in which the states are drawn; nothing moves there.
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
        self._state: WorldState | None = None
        self._taken: dict[Camera, np.ndarray] = {}

    def shots(self, state: WorldState, goals: Sequence[Goal] = (), arm: str | None = None) -> dict[str, np.ndarray]:
        """(H, W, 3) uint8 RGB pictures by camera: the views for some goals, wrist cameras, and for a scan close ones.

        Pictures of the state before are not taken again: one sub-task begins as the one before it ended.

        Args:
            state: that is shown.
            goals: of the sub-task.
            arm: whose wrist camera looks on, and the others only where the moment needs them; without one all look.
        """
        if self._state is None or not state.same_as(self._state):
            self._state, self._taken = state, {}
        self.world.set_state(state)
        return {name: self._picture(camera) for name, camera in self._cameras(goals, arm).items()}

    def _cameras(self, goals: Sequence[Goal], arm: str | None) -> dict[str, Camera]:
        """The cameras of :meth:`shots`, as the world stands."""
        wanted = arm is None or any(goal.kind.shown.moment for goal in goals)
        taken_by = cameras(self._scene, goals) if wanted else {}
        of_robot = robot_cameras(self.world)
        arms = {name: self._robot.cameras[name].arm for name in of_robot}
        taken_by |= {name: c for name, c in of_robot.items() if arms[name] and arm in (None, arms[name])}
        for goal in goals if arm is not None else ():
            if goal.kind.shown.close_up:
                taken_by |= scan_cameras(self.world, self._objects, goal.subject)
        return taken_by

    def _picture(self, camera: Camera) -> np.ndarray:
        if camera not in self._taken:
            self._taken[camera] = shoot(self.world, camera)
        return self._taken[camera]

    def empty_table(self) -> np.ndarray:
        """The view from above of the table with nothing on it, the robot as it is."""
        state = self.world.state()
        away = {key: Pose([0.0, 0.0, -9.0 - number]) for number, key in enumerate(state.objects)}
        self.world.set_state(WorldState(away, state.joints, state.object_joints))
        picture = shoot(self.world, self._scene.top_camera.camera())
        self.world.set_state(state)
        return picture


# --- close pictures of a scan ----------------------------------------------------------------------------------


CODE, WINDOW = "code", "window"
"""Cameras that look at the bar code with the scanner before it, and at the scanner's window."""


@dataclass(frozen=True)
class CloseUpSettings:
    """Places from which a camera looks at a face.

    Args:
        width, height: of the picture, pixels.
        fovy_rad: its vertical field of view.
        away_m: from the face.
        beside_rad: angles between the face's axis and the camera, seen from above, in the order to try them: steep
            enough to look past an object held before the face, and flat enough to see it.
        above_rad: angles of the camera over the face's axis, in the order to try them.
        sampled_m: half the side of the square on the face with the points to be seen.
        depth_m: a surface farther than this before or behind a point hides it.
        enough_share: share of the points that are seen from where no other place is tried.
    """

    width: int = 640
    height: int = 480
    fovy_rad: float = 0.55
    away_m: float = 0.32
    beside_rad: tuple[float, ...] = tuple(np.radians([50.0, -50.0, 65.0, -65.0, 35.0, -35.0]))
    above_rad: tuple[float, ...] = tuple(np.radians([20.0, 40.0]))
    sampled_m: float = 0.008
    depth_m: float = 0.004
    enough_share: float = 0.9


SETTINGS = CloseUpSettings()


def scan_cameras(world: World, objects: Sequence[SceneObject], thing: str) -> dict[str, Camera]:
    """The cameras that show how a thing and a scanner face each other in a world, by name; none without both.

    Of several bar codes and windows the two that are nearest to each other are shown. Where something stands in the
    way on all sides, the place is taken from which most is seen.

    Args:
        world: to render, in its present state.
        objects: by their faces; poses are the world's.
        thing: id of the object with the bar code.
    """
    now = [o.moved(world.object_pose(o.id)) for o in objects]
    codes = [_Seen.of(o, face) for o in now if o.id == thing for face in o.asset.annotation.faces_of("code")]
    windows = [_Seen.of(o, face) for o in now if o.id != thing for face in o.asset.annotation.faces_of("reader")]
    pairs = [(float(np.linalg.norm(a.at - b.at)), n, a, b) for n, (a, b) in enumerate(product(codes, windows))]
    if not pairs:
        return {}
    _, _, code, window = min(pairs, key=lambda pair: pair[:2])
    return {CODE: _clearest(world, code), WINDOW: _clearest(world, window)}


@dataclass(frozen=True)
class _Seen:
    """A face in the world: (3,) where its middle is, and (3,) where it looks."""

    at: np.ndarray
    axis: np.ndarray

    @classmethod
    def of(cls, thing: SceneObject, face: Face) -> _Seen:
        return cls(thing.pose.apply(face.position), thing.pose.rotation() @ np.asarray(face.axis))

    def points(self) -> np.ndarray:
        """(9, 3) points of a square on it."""
        across = np.cross(self.axis, [0.0, 0.0, 1.0] if abs(self.axis[2]) < 0.9 else [1.0, 0.0, 0.0])
        across /= np.linalg.norm(across)
        steps = SETTINGS.sampled_m * np.array(list(product((-1, 0, 1), repeat=2)))
        return self.at + steps @ np.stack([across, np.cross(self.axis, across)])

    def cameras(self) -> Iterator[Camera]:
        """The cameras that face it, in the order to try them."""
        heading = np.arctan2(self.axis[1], self.axis[0])
        for above, beside in product(SETTINGS.above_rad, SETTINGS.beside_rad):
            angle = heading + beside
            way = np.array([np.cos(above) * np.cos(angle), np.cos(above) * np.sin(angle), np.sin(above)])
            pose = look_at(self.at + SETTINGS.away_m * way, self.at)
            yield Camera(SETTINGS.width, SETTINGS.height, SETTINGS.fovy_rad, pose)


def _clearest(world: World, face: _Seen) -> Camera:
    """The first camera that sees enough of a face, else the one that sees most of it."""
    best: tuple[float, Camera] | None = None
    for camera in face.cameras():
        share = _visible_share(world, camera, face.points())
        if best is None or share > best[0]:
            best = share, camera
        if share >= SETTINGS.enough_share:
            break
    assert best is not None  # the settings name some places
    return best[1]


def _visible_share(world: World, camera: Camera, points: np.ndarray) -> float:
    """Share of points (n, 3) that nothing hides from a camera."""
    depth = observe(world, camera).depth
    u, v = np.clip(camera.project(points).astype(int), 0, np.array([camera.width, camera.height]) - 1).T
    away = camera.pose.inverse().apply(points)[:, 0]
    return float(np.mean(np.abs(depth[v, u] - away) <= SETTINGS.depth_m))
