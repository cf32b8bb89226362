"""Starts of episodes: the changes to the world, the poses of its objects, and the grasps and slots of the chain."""

from __future__ import annotations

import logging
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import repeat

import numpy as np

from vcage.base.attempts import LIMITS, GaveUp, Refused, first_accepted
from vcage.base.errors import InfeasibleScene, NoFeasibleTask
from vcage.base.geometry import Pose
from vcage.episodes.layouts import Layout, Layouts, NoLayout
from vcage.episodes.worlds import Worlds, drawn_models, free_start, left_with, other_phrases, steady, weighed
from vcage.runs.context import StageContext
from vcage.scenes.possible import settled_record
from vcage.schema.asset import PhysicalModel
from vcage.schema.plan import Relation
from vcage.schema.randomisation import WorldDraw, WorldRanges
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Grasp, Subtask
from vcage.tasks.chain_slots import slots_for_chain
from vcage.tasks.described import complaints
from vcage.tasks.proven_chain import proven
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.slots import Slot
from vcage.tasks.variation import shifted_poses
from vcage.tasks.workplace import Workplace

logger = logging.getLogger(__name__)

CLUTTER_SHARES = (1.0, 0.5, 0.0)
"""Shares of the clutter with which layouts are drawn, in turn; without clutter, objects have the run's own variants."""


@dataclass(frozen=True)
class Start:
    """The start of an episode.

    Args:
        scene: as it is then.
        objects: of the scene.
        grasps: of each sub-task, by its id, best first.
        slots: where each sub-task puts its object, by its id.
        drawn: True if the layout was drawn; otherwise it is the run's, with small shifts or without.
        refused: drawn layouts that were refused: reason → number.
        world: its differences from the run's scene.
        models: of the objects, by id, with their drawn mass and friction.
        phrases: new phrases by those of the run's scene (:func:`~vcage.episodes.worlds.other_phrases`).
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
        scene: at the start of the chain, with an optimised layout.
        relations: of the plan, kept by drawn layouts; None without drawn layouts.
        chain: the sub-tasks, in order.
        ranges: of the differences between worlds.
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
        stood = layout or self._shifted_layout(scene, list(objects.values()), rng)
        objects = {name: o.moved(stood.poses[name]) for name, o in objects.items()}
        scene = self._with(scene, objects.values())
        models = self._context.physical_models(scene)
        world = free_start(scene, models, weighed(world, self._ranges, models, rng))
        return Start(
            scene=scene,
            objects=objects,
            grasps=stood.grasps,
            slots=stood.slots,
            drawn=layout is not None,
            refused=refused,
            world=world,
            models=drawn_models(models, world),
            phrases=other_phrases(self._scene, scene.objects),
        )

    def _laid_out(self, rng: np.random.Generator) -> tuple[WorldDraw, Layout | None, dict[str, int]]:
        """The world that was drawn, a layout of it or None, and the number of refused layouts by reason."""
        drawn = self._worlds.draw(self._ranges, rng)
        if self._relations is None:
            return drawn, None, {}
        worlds = list(_eased(drawn))
        try:
            found = first_accepted((partial(self._layout_of, *world, rng) for world in worlds), NoLayout)
        except GaveUp as error:
            logger.warning("no random layout was accepted: objects stand as optimised, with small shifts if these do")
            return worlds[-1][0], None, _refused(error.refusals)
        world, layout = found.value
        return world, layout, dict(Counter(_refused(found.refusals)) + Counter(layout.refused))

    def _layout_of(self, world: WorldDraw, draws: int, rng: np.random.Generator) -> tuple[WorldDraw, Layout]:
        """A layout of a world, and the world with the clutter that stays put in it.

        Raises:
            NoLayout: all were refused.
        """
        assert self._relations is not None, "layouts are drawn by the relations of a plan"
        scene, clutter = self._worlds.changed(world), self._worlds.clutter(world)
        layout = Layouts(scene, self._relations, self._chain, self._context).draw(rng, clutter, draws)
        objects = [*self._context.objects(scene), *(o for o in clutter if o.id in layout.poses)]
        stood = self._with(scene, [o.moved(layout.poses[o.id]) for o in objects])
        return steady(stood, self._context.physical_models(stood), left_with(world, layout.poses)), layout

    def _shifted_layout(self, scene: Scene, objects: Sequence[SceneObject], rng: np.random.Generator) -> Layout:
        """The run's layout with small shifts in which the chain is proven; without shifts where none is found.

        Where the chain is proven in none of them, the planned grasps are taken, and slots for them.
        """

        def at(poses: Mapping[str, Pose], slot_sets: int) -> Layout:
            stood = [o.moved(poses[o.id]) for o in objects]
            chain, slots = proven(self._chain, stood, self._with(scene, stood), rng, slot_sets)
            return Layout(dict(poses), {subtask.id: subtask.grasps for subtask in chain}, slots)

        shifted = repeat(lambda: at(self._shifted(scene, objects, rng), LIMITS.slot_sets), LIMITS.proven_shifts)
        unshifted = {o.id: o.pose for o in objects}
        proposals = [*shifted, partial(at, unshifted, LIMITS.final_slot_sets)]
        try:
            return first_accepted(proposals, (NoFeasibleTask, InfeasibleScene)).value
        except GaveUp as error:
            logger.info("%s", error.refusals[-1])
        slots = slots_for_chain(self._chain, Workplace.of(scene, objects, rng))
        return Layout(unshifted, {subtask.id: subtask.grasps for subtask in self._chain}, slots)

    def _shifted(self, scene: Scene, objects: Sequence[SceneObject], rng: np.random.Generator) -> dict[str, Pose]:
        """Poses a little off the run's, at which all descriptions stay true; the run's where none are found."""

        def shift() -> dict[str, Pose]:
            poses = shifted_poses(objects, rng)
            if false := complaints(scene, [o.moved(poses[o.id]) for o in objects]):
                raise Refused(false[0])
            return poses

        try:
            return first_accepted(repeat(shift, LIMITS.shifts)).value
        except GaveUp:
            return {o.id: o.pose for o in objects}

    def _with(self, scene: Scene, objects: Iterable[SceneObject]) -> Scene:
        """The scene with objects where they are."""
        records = [settled_record(o.record, o.pose, self._context) for o in objects]
        return scene.model_copy(update={"objects": records})


def _refused(refusals: Iterable[Exception]) -> dict[str, int]:
    """Number of refused layouts by reason, over several searches."""
    return dict(sum((Counter(e.details["refused"]) for e in refusals if isinstance(e, NoLayout)), Counter()))


def _eased(world: WorldDraw) -> Iterator[tuple[WorldDraw, int]]:
    """The world that was drawn, then the same with fewer and fewer objects; and the draws of layouts for each."""
    if not world.clutter and not world.variants:
        yield world, LIMITS.episode_layouts
        return
    for share in CLUTTER_SHARES:
        kept = list(world.clutter)[: int(share * len(world.clutter))]
        variants = world.variants if share else {}
        yield left_with(world.model_copy(update={"variants": variants}), kept), LIMITS.eased_layouts
