"""Find the nearest layout in which the instruction can be carried out."""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from vcage.base.attempts import LIMITS, GaveUp, Refused, first_accepted
from vcage.base.errors import InfeasibleScene, NoFeasibleTask
from vcage.base.geometry import Pose
from vcage.layout.optimize import LayoutOptions, LayoutResult
from vcage.layout.stowed import with_stowed
from vcage.runs.context import StageContext
from vcage.scenes.layout_items import Targets, nearest_layout
from vcage.scenes.possible import settled_record
from vcage.schema.scene import Scene
from vcage.tasks.described import require_settled
from vcage.tasks.ground import FACING
from vcage.tasks.proven_chain import require_chain

logger = logging.getLogger(__name__)

HEADED = (*FACING, "held_by_both")
"""Goals of things that must end at a heading which they may not have at the start, or that only lie in the reach of two
hands at some headings."""

SHIFT_STEP_M = 0.03
"""Standard deviation by which the targets of each layout are shifted more than those of the one before it."""


@dataclass(frozen=True)
class LaidOut:
    """A layout, its scene, and the standard deviation of the shift of its targets."""

    result: LayoutResult
    scene: Scene
    shift_m: float


@dataclass(frozen=True)
class NearestFeasible:
    """Search for the nearest layout in which the instruction can be carried out.

    Args:
        scene: as it was placed.
        targets: the layout that is wanted.
        rng: makes the same random numbers again.
        options: of the optimisation.
        context: the library, and the reach of the robots.
    """

    scene: Scene
    targets: Targets
    rng: Callable[[], np.random.Generator]
    options: LayoutOptions
    context: StageContext

    def layout(self) -> LaidOut:
        """The layout nearest to the targets in which the instruction can be carried out.

        Layouts near targets that are shifted further and further are tried, and in each what must be put down at a
        heading, or held by both arms, is turned by one more quarter: an arm's wrist turns a thing only so far. If none
        does, the nearest is taken in which all descriptions are true, and the search for sub-tasks reports its faults.

        Raises:
            InfeasibleScene: there is no layout, or none in which all descriptions are true; names the fault.
        """
        shifting = self.rng()
        try:
            return first_accepted(partial(self._proven, number, shifting) for number in range(LIMITS.layouts)).value
        except GaveUp as error:
            laid_out = [refusal.about for refusal in error.refusals if isinstance(refusal, Refused)]
            nearest = next((one for one in laid_out if isinstance(one, LaidOut)), None)
            if nearest is None:
                raise laid_out[0] from None
            return nearest

    def _proven(self, number: int, shifting: np.random.Generator) -> LaidOut:
        """A layout near shifted targets in which the instruction can be carried out.

        Raises:
            Refused: it cannot, or there is no layout in which all descriptions are true; about the layout or the error.
            InfeasibleScene: there is no layout at the targets themselves, and no description asks for another.
        """
        try:
            found = self._near(number * SHIFT_STEP_M, shifting, number * np.pi / 2)
        except InfeasibleScene as error:
            if number == 0 and not self.scene.descriptions:
                raise
            raise Refused(error.message, error) from None
        if self.scene.instruction is not None:
            try:
                require_chain(found.scene, self.context.objects(found.scene), self.rng())
            except (NoFeasibleTask, InfeasibleScene) as error:
                logger.info("another layout is tried: %s", error.message)
                raise Refused(error.message, found) from None
        return found

    def _near(self, shift_m: float, shifting: np.random.Generator, turn: float) -> LaidOut:
        """The layout nearest to targets that are shifted at random.

        Args:
            shift_m: standard deviation of the shifts.
            shifting: of the shifts.
            turn: of what is to be put down at a heading, radians.

        Raises:
            InfeasibleScene: there is none, or not all descriptions are true in it.
        """
        scene = self.scene
        targets = {key: self._turned(key, target, turn) for key, target in self.targets.poses.items()}
        shifts = shifting.normal(0.0, shift_m, (len(targets), 2))
        asked = {key: Pose([*(t.p[:2] + s), t.p[2]], t.q) for (key, t), s in zip(targets.items(), shifts, strict=True)}
        result = nearest_layout(scene, replace(self.targets, poses=asked), self.rng, self.options, self.context)
        poses = {key: Pose.from_yaw(at, targets[key].yaw) for key, at in result.positions.items()}
        laid_out = with_poses(scene, self.context, with_stowed(scene, poses), result)
        models, objects = self.context.physical_models(laid_out), self.context.objects(laid_out)
        require_settled(laid_out, models, objects, "the nearest layout without collisions", None)
        displaced = {key: float(np.hypot(*(poses[key].p - target.p)[:2])) for key, target in targets.items()}
        return LaidOut(replace(result, displaced=displaced), laid_out, round(shift_m, 3))

    def _turned(self, name: str, target: Pose, turn: float) -> Pose:
        """The target of an object; turned where the task depends on its heading."""
        headed = any(asked.goal.subject == name and asked.goal.relation in HEADED for asked in self.scene.goals)
        if not headed or self.context.asset(self.scene.object(name)).articulated:
            return target
        return Pose.from_yaw(target.p, target.yaw + turn)


def with_poses(
    scene: Scene, context: StageContext, poses: dict[str, Pose], result: LayoutResult | None = None
) -> Scene:
    """The scene with its objects at other poses, and in the containers that the optimisation found."""
    records = [settled_record(o, poses[o.id], context) for o in scene.objects]
    if result is not None:
        records = [o.model_copy(update={"container": result.containers.get(o.id, o.container)}) for o in records]
    return scene.model_copy(update={"objects": records, "segmentation_ids": {}, "checks": {}})
