"""The context that the stages of one process share: library, models and kinematics, each built when needed."""

from __future__ import annotations

import logging
from collections.abc import Collection, Hashable, Mapping
from dataclasses import replace
from functools import cached_property, partial

import numpy as np

from vcage.base.geometry import Camera, Pose
from vcage.base.memory import Recent
from vcage.layout.capacities import capacity_of
from vcage.layout.items import TableItem
from vcage.layout.placement.reach import reach_for, robot_reach
from vcage.layout.placement.reach_map import SETTINGS as REACH
from vcage.layout.placement.reach_map import Tilted
from vcage.models.agent import PROVIDER as AGENT
from vcage.models.protocols import Models
from vcage.models.registry import DETECTORS, EMBEDDERS, Choice, build_models
from vcage.objects.asset import Asset, unbuilt_entry
from vcage.objects.library import Library
from vcage.objects.surface_pictures import surface_picture
from vcage.schema.asset import CatalogueEntry, PhysicalModel
from vcage.schema.scene import ObjectRecord, Role, Scene, SceneTemplate, Table, Workspace
from vcage.sim.appearance import Appearance
from vcage.sim.drawer import Drawing, ModelDrawer, Window, reference_view
from vcage.sim.kinematics import ArmKinematics, kinematics_of
from vcage.sim.robots import load_robot
from vcage.sim.world import World
from vcage.tasks.scene_objects import SceneObject
from vcage.vision.protocols import Reference

logger = logging.getLogger(__name__)

METRES_PER_PIXEL = 0.0015
"""Scale of the reference pictures of assets, about that of the top camera."""


DRAWINGS_BYTES = 48_000_000
"""Of the drawings of single objects that are kept: in a scene of five objects, those of two or three sub-tasks."""


class StageContext:
    """Shared by the stages of one process.

    Example:
        >>> context = StageContext("offline")
        >>> context.objects(Scene.read(RunFolder("runs/blocks").layout))

    Args:
        models, detector, embedder: which models answer (see :func:`vcage.models.registry.build_models`).
    """

    def __init__(self, models: Choice | str = "auto", detector: str = DETECTORS[0], embedder: str = EMBEDDERS[0]):
        self._choice = Choice(models) if isinstance(models, str) else models
        self._networks = detector, embedder
        self._references: dict[tuple[str, str, tuple[float, ...]], np.ndarray] = {}
        self._drawers: dict[tuple[str, str], ModelDrawer] = {}
        self._drawings: Recent[Hashable, Drawing] = Recent(DRAWINGS_BYTES)
        self._reach: dict[tuple[str, Workspace, Table, bool, str | None, Tilted], np.ndarray] = {}

    @cached_property
    def library(self) -> Library:
        return Library.load()

    @cached_property
    def catalogue(self) -> list[CatalogueEntry]:
        return self.library.entries()

    @cached_property
    def annotated(self) -> list[CatalogueEntry]:
        """All kinds, without facts that need their models, such as sizes; names need none of these."""
        return [unbuilt_entry(self.library.annotation(name)) for name in self.library.names]

    @cached_property
    def models(self) -> Models:
        return build_models(self._choice, *self._networks)

    @cached_property
    def at_once(self) -> StageContext:
        """The same context with a critic that answers immediately: rules in place of an agent."""
        if not self.models.critic.provider.startswith(AGENT):  # or is replayed
            return self
        logger.info("the agent judges in verify, not while the robot waits: until then rules judge the sub-tasks")
        return StageContext(replace(self._choice, critic="offline"), *self._networks)

    def kinematics(self, robot: str) -> Mapping[str, ArmKinematics]:
        """Return the kinematics of a robot, by arm."""
        return {name: kinematics_of(arm) for name, arm in load_robot(robot).arms.items()}

    def within_reach(
        self,
        asset: Asset,
        role: Role,
        setup: Scene | SceneTemplate,
        yaw: float | None = None,
        every: bool = False,
        arm: str | None = None,
    ) -> np.ndarray | None:
        """Return rectangles (m, 2, 2) of the table where an asset may stand, as its arms reach.

        See :func:`~vcage.layout.placement.reach.reach_for`.

        Args:
            asset, role: of the object.
            setup: robot, table and workspace.
            yaw: its heading, if known.
            every: require reach of every arm, not of some arm.
            arm: require reach of this arm.
        """
        tilted = Tilted.of(asset, role, yaw)
        key = (setup.robot, setup.workspace, setup.table, every, arm, tilted)
        if key not in self._reach:
            bounds, robot = np.array([setup.workspace.lower, setup.workspace.upper]), load_robot(setup.robot)
            heights = tuple(setup.table.height + h for h in REACH.grasp_heights_m)
            asked = robot if arm is None else robot.model_copy(update={"arms": {arm: robot.arms[arm]}})
            self._reach[key] = robot_reach(asked, bounds, heights, every=every, tilted=tilted)
        return reach_for(asset, role, self._reach[key])

    def asset(self, record: ObjectRecord) -> Asset:
        """Return the asset of an object.

        Raises:
            UnknownName: the library has no such asset or variant.
        """
        return self.library.asset(record.asset, record.variant)

    def objects(self, scene: Scene, poses: Mapping[str, Pose] | None = None) -> list[SceneObject]:
        """Return the objects of a scene with their geometry, at their own poses or at those given."""
        poses = poses or {}
        return [SceneObject(r, self.asset(r), poses.get(r.id, r.pose.pose()), r.joints) for r in scene.objects]

    def capacities(self, scene: Scene) -> dict[str, TableItem]:
        """Return the size of each object and its room for others, by object id."""
        return {record.id: capacity_of(record.id, self.asset(record)) for record in scene.objects}

    def physical_models(self, scene: Scene) -> dict[str, PhysicalModel]:
        """Return the models for the simulator, by object id."""
        return {record.id: self.asset(record).model for record in scene.objects}

    def reference(self, record: ObjectRecord, joints: tuple[float, ...] = ()) -> tuple[np.ndarray, float]:
        """Return the top view of an object, (h, w, 4) RGBA, and its metres per pixel.

        Args:
            joints: positions of its moving parts; all at rest when empty.
        """
        key = (record.asset, record.variant, joints)
        if key not in self._references:
            self._references[key] = reference_view(self.asset(record).model, METRES_PER_PIXEL, joints=joints)
        return self._references[key], METRES_PER_PIXEL

    def drawing(
        self, record: ObjectRecord, pose: Pose, camera: Camera, window: Window, shares: Mapping[str, float]
    ) -> Drawing:
        """Draw one object as a camera sees it, with some parts at a share of their range and the others at rest.

        Recent drawings are kept: a critic looks for most objects in the same places after each sub-task.
        """
        model, name = self.asset(record).model, (record.asset, record.variant)
        if name not in self._drawers:
            self._drawers[name] = ModelDrawer({record.asset: model})
        joints = tuple(shares.get(link.name, 0.0) * link.joint.far_end for link in model.links)
        draw = partial(self._drawers[name].draw, record.asset, pose, camera, window, joints)
        return self._drawings.get((*name, pose, camera, window, joints), draw, lambda drawing: drawing.nbytes)

    def look(self, record: ObjectRecord, opened: Collection[str] = ()) -> Reference:
        """Return the reference look of an object for the critic, with some parts open, pressed or turned."""
        asset = self.asset(record)
        joints = tuple(link.joint.far_end if link.name in opened else 0.0 for link in asset.model.links if opened)
        x, y, z = (float(length) for length in asset.size)
        return Reference(record.phrase, *self.reference(record, joints), (x, y, z))

    def drawn_world(self, scene: Scene) -> World:
        """Return a world of a scene to take pictures of, in its plain look: studio light, the table's own texture."""
        look = Appearance(table_texture=surface_picture("table", scene.table.texture))
        return World.of_scene(scene, self.physical_models(scene), appearance=look, render=True)
