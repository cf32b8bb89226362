"""Where an episode begins: what its world has otherwise, where things stand in it, and how the chain is done there."""

from __future__ import annotations

import logging
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from vcage.base.errors import NoFeasibleTask
from vcage.base.geometry import Pose
from vcage.episodes.layouts import DRAWS, Layout, Layouts, NoLayout
from vcage.episodes.worlds import Worlds, drawn_models, free_start, left_with, other_phrases, steady, weighed
from vcage.runs.context import StageContext
from vcage.scenes.possible import settled_record
from vcage.schema.asset import PhysicalModel
from vcage.schema.plan import Relation
from vcage.schema.randomisation import WorldDraw, WorldRanges
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Grasp, Subtask
from vcage.sim.robots import load_robot
from vcage.tasks.described import complaints
from vcage.tasks.ground import Ground
from vcage.tasks.rehearsal import proven
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.slots import Slot, slots_for_chain
from vcage.tasks.variation import shifted_poses

logger = logging.getLogger(__name__)

EASED = ((1.0, 10), (0.5, 10), (0.0, 10))
"""Shares of the clutter with which layouts are drawn, and how many with each, before there are fewer; the last also
have the run's own variants."""


SHIFTS = 8
"""Small shifts of the run's layout that are drawn for one at which what is described stays true."""


@dataclass(frozen=True)
class Start:
    """Where an episode begins.

    Args:
        scene: as it is then.
        objects: of the scene.
        grasps: of each sub-task, by its id, best first.
        slots: where each sub-task puts its object, by its id.
        drawn: whether the layout was drawn; otherwise it is the run's with small shifts.
        refused: why layouts that were drawn were not taken: reason → how many.
        world: what is simulated otherwise than the run's scene says.
        models: of the objects, by id, as heavy as was drawn.
        phrases: what is called otherwise than in the run's scene (:func:`~vcage.episodes.worlds.other_phrases`).
    """

    scene: Scene
    objects: dict[str, SceneObject]
    grasps: Mapping[str, Sequence[Grasp]]
    slots: dict[str, Slot]
    drawn: bool
    refused: dict[str, int]
    world: WorldDraw
    models: dict[str, PhysicalModel]
    phrases: dict[str, str]


class Starts:
    """Draws where the episodes of a chain begin.

    Args:
        scene: as it is before the chain begins, where its layout was optimised.
        relations: of the plan, which layouts keep that are drawn; None where none are.
        chain: the sub-tasks, in order.
        ranges: of what is simulated otherwise.
        context: the library, the robots' reach and kinematics.
    """

    def __init__(
        self,
        scene: Scene,
        relations: Sequence[Relation] | None,
        chain: Sequence[Subtask],
        ranges: WorldRanges,
        context: StageContext,
    ):
        self._scene, self._relations, self._chain, self._ranges = scene, relations, chain, ranges
        self._context, self._worlds = context, Worlds(scene, chain, context)

    def draw(self, rng: np.random.Generator) -> Start:
        """A world, and a layout of it in which the chain is feasible; the run's own where none is found."""
        world, layout, refused = self._laid_out(rng)
        scene = self._worlds.changed(world)
        objects = {o.id: o for o in (*self._context.objects(scene), *self._worlds.clutter(world))}
        poses = self._shifted(scene, list(objects.values()), rng) if layout is None else layout.poses
        objects = {name: o.moved(poses[name]) for name, o in objects.items()}
        scene = self._with(scene, objects.values())
        grasps, slots = self._proven(scene, objects, rng) if layout is None else (layout.grasps, layout.slots)
        models = self._context.physical_models(scene)
        world = free_start(scene, models, weighed(world, self._ranges, models, rng))
        return Start(
            scene=scene,
            objects=objects,
            grasps=grasps,
            slots=slots,
            drawn=layout is not None,
            refused=refused,
            world=world,
            models=drawn_models(models, world),
            phrases=other_phrases(self._scene, scene.objects),
        )

    def _laid_out(self, rng: np.random.Generator) -> tuple[WorldDraw, Layout | None, dict[str, int]]:
        """What was drawn, a layout of it, and why others were not taken; without a layout where none was found."""
        drawn, refused = self._worlds.draw(self._ranges, rng), Counter[str]()
        if self._relations is None:
            return drawn, None, {}
        world = drawn
        for world, draws in _eased(drawn):
            scene, clutter = self._worlds.changed(world), self._worlds.clutter(world)
            try:
                layout = Layouts(scene, self._relations, self._chain, self._context).draw(rng, clutter, draws)
            except NoLayout as error:
                refused.update(error.details["refused"])
                continue
            placed = [o.moved(layout.poses[o.id]) for o in clutter if o.id in layout.poses]
            objects = [o.moved(layout.poses[o.id]) for o in self._context.objects(scene)]
            stood = self._with(scene, [*objects, *placed])
            world = steady(stood, self._context.physical_models(stood), left_with(world, layout.poses))
            refused.update(layout.refused)
            return world, layout, dict(refused)
        logger.warning("no layout that was drawn was taken: objects stand as optimised, with small shifts")
        return world, None, dict(refused)

    def _shifted(self, scene: Scene, objects: Sequence[SceneObject], rng: np.random.Generator) -> dict[str, Pose]:
        """Poses a little off the run's, at which what is described is still true; the run's where none are found."""
        for _ in range(SHIFTS):
            poses = shifted_poses(objects, rng)
            if not complaints(scene, [o.moved(poses[o.id]) for o in objects]):
                return poses
        return {o.id: o.pose for o in objects}

    def _with(self, scene: Scene, objects: Iterable[SceneObject]) -> Scene:
        """The scene with objects where they are."""
        records = [settled_record(o.record, o.pose, self._context) for o in objects]
        return scene.model_copy(update={"objects": records})

    def _proven(
        self, scene: Scene, objects: Mapping[str, SceneObject], rng: np.random.Generator
    ) -> tuple[dict[str, list[Grasp]], dict[str, Slot]]:
        """Grasps and slots where the run's layout is a little shifted; as planned there where that breaks a step."""
        chain, things = self._chain, list(objects.values())
        try:
            chain, slots = proven(chain, things, scene, rng)
        except NoFeasibleTask as error:
            logger.info("%s", error.message)
            slots = slots_for_chain(chain, things, load_robot(scene.robot), Ground.of(scene), rng)
        return {subtask.id: subtask.grasps for subtask in chain}, slots


def _eased(world: WorldDraw) -> Iterator[tuple[WorldDraw, int]]:
    """What was drawn, then less and less of what takes room; and how many layouts are drawn with each."""
    if not world.clutter and not world.variants:
        yield world, DRAWS
        return
    for share, draws in EASED:
        kept = list(world.clutter)[: int(share * len(world.clutter))]
        variants = world.variants if share else {}
        yield left_with(world.model_copy(update={"variants": variants}), kept), draws
