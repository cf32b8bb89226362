"""Layouts of episodes: relations are kept, places and headings are random, and the chain is proven in each.

Objects are placed at random where the robot reaches (:mod:`vcage.layout.placement`); from there the optimisation
(:mod:`vcage.layout.optimize`) takes them to the nearest layout that keeps the plan and its margins.
"""

from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import repeat
from typing import get_args

import numpy as np

from vcage.base.attempts import LIMITS, GaveUp, Refused, first_accepted, least_costly
from vcage.base.errors import InfeasibleScene, NoFeasibleTask
from vcage.base.geometry import Pose, world_aabb, wrap_angle
from vcage.layout.items import ANY_YAW, FRONT_YAWS, TableItem, hand_clearance, table_item
from vcage.layout.optimize import LayoutOptions
from vcage.layout.placement.place import place
from vcage.plans.descriptions import described_relations
from vcage.plans.kept import relations_kept, relations_kept_in
from vcage.plans.relations import ground_box
from vcage.runs.context import StageContext
from vcage.scenes.layout_items import Targets, choices_of_arms, layout_items, nearest_layout
from vcage.schema.goals import Goal
from vcage.schema.plan import TABLE, Relation, RelationWord
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Grasp, Subtask
from vcage.sim.robots import load_robot
from vcage.tasks.chain_rehearsal import examined
from vcage.tasks.described import complaints
from vcage.tasks.ground import FACING
from vcage.tasks.proven_chain import proven
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.slots import Slot
from vcage.tasks.state import StillState
from vcage.tasks.truth import goals_hold
from vcage.tasks.workplace import Workplace

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class EpisodeLayoutSettings:
    """Settings of the layouts that are drawn for episodes.

    Args:
        turns_rad: turns of a receptacle from its heading in the run's layout: its front stays towards the robot.
        most_turned_rad: largest turn of a thing to the heading at which it is to be put down, as a wrist turns only
            so far: on ``aloha_agilex`` hardly any place before the customer is reached after half a turn.
        restarts: of the optimisation of a layout; another draw is a better start.
        clutter_gap_m: gap of clutter to everything.
    """

    turns_rad: tuple[float, ...] = tuple(float(turn) for turn in np.radians((-20, -10, 0, 10, 20)))
    most_turned_rad: float = np.pi / 2
    restarts: int = 2
    clutter_gap_m: float = 0.04


SETTINGS = EpisodeLayoutSettings()


@dataclass(frozen=True)
class Layout:
    """A layout in which an episode starts.

    Args:
        poses: of every object in the world, by id.
        grasps: of each sub-task of the chain, by its id, best first.
        slots: where each sub-task puts its object, by its id.
        refused: layouts drawn before it and refused: reason → number.
    """

    poses: dict[str, Pose]
    grasps: dict[str, list[Grasp]]
    slots: dict[str, Slot]
    refused: dict[str, int] = field(default_factory=dict)


class NoLayout(InfeasibleScene):
    """All drawn layouts were refused; ``details["refused"]`` counts the reasons."""

    code = "no_layout"


class Layouts:
    """Draws layouts of a scene in which a chain can be carried out.

    Args:
        scene: at the start of the chain, with an optimised layout.
        relations: of the plan; the satisfied ones are preserved, and so are the scene's descriptions.
        chain: the sub-tasks, in order.
        context: the library, the robots' reach and kinematics.
    """

    def __init__(self, scene: Scene, relations: Sequence[Relation], chain: Sequence[Subtask], context: StageContext):
        self._scene, self._chain, self._context = scene, chain, context
        self._goals = {goal for subtask in chain for goal in subtask.goals}
        broken = relations_kept_in(scene, relations).broken
        self._described = described_relations(scene.laid_out)
        self._relations = list(dict.fromkeys([*self._described, *(r for r in relations if r not in broken)]))
        self._objects = {o.id: o for o in context.objects(scene)}
        self._inside = {o.id: o.record.container for o in self._objects.values() if o.record.container is not None}
        self._workspace = np.array([scene.workspace.lower, scene.workspace.upper])
        self._on = ground_box(scene.workspace, scene.table.height)
        self._margin = float(scene.provenance.options.get("margin", LayoutOptions.margin))
        self._robot = load_robot(scene.robot)
        now = {name: o.pose for name, o in self._objects.items()}
        # A chain may bring a thing back to where descriptions say that it is at the start.
        self._fulfilled_before = {g for g in self._fulfilled(now) if g.relation in get_args(RelationWord)}
        self._standing = [
            replace(item, yaws=self._headings(self._objects[item.id]))
            for item in layout_items(scene, Targets(now, self._inside), context)
            if item.id not in self._inside
        ]
        self._for_one_arm = choices_of_arms(self._standing, scene, context)
        standing = {item.id for item in self._standing} | {TABLE}
        self._between = [r for r in self._described if {r.subject, r.reference} <= standing]

    def draw(
        self, rng: np.random.Generator, clutter: Sequence[SceneObject] = (), draws: int = LIMITS.episode_layouts
    ) -> Layout:
        """Return a layout that is drawn at random.

        Args:
            rng: of all draws.
            clutter: objects outside the scene; as many as have room are placed in the remaining space.
            draws: layouts to draw before giving up.

        Raises:
            NoLayout: all of them were refused.
        """
        try:
            found = first_accepted(repeat(partial(self._draw_one, rng, clutter), draws))
        except GaveUp as error:
            reason, count = error.reasons.most_common(1)[0]
            raise NoLayout(
                f"none of {draws} layouts that were drawn was taken, {count} as {reason}",
                hint="take the one that there is: --layout fixed",
                details={"refused": dict(error.reasons)},
            ) from None
        return replace(found.value, refused=found.reasons)

    def _draw_one(self, rng: np.random.Generator, clutter: Sequence[SceneObject]) -> Layout:
        """Draw a layout and verify it.

        Raises:
            Refused: it fails a check.
        """
        try:
            poses = self._solved(rng)
        except InfeasibleScene:
            raise Refused("there is no room") from None
        boxes = self._boxes(poses)
        self._require_described(poses, boxes)
        poses |= self._poses_of_clutter(clutter, boxes, rng)
        objects = [o.moved(poses[o.id]) for o in (*self._objects.values(), *clutter) if o.id in poses]
        workplace = Workplace.of(self._scene, objects, rng)
        chain = [self._examined(subtask, workplace) for subtask in self._chain]
        try:
            chain, slots = proven(chain, objects, self._scene, rng)
        except InfeasibleScene:
            raise Refused("there is no room where things are put") from None
        except NoFeasibleTask as error:
            logger.debug("a layout is refused: %s", error.message)
            raise Refused(error.details["refused"]) from None
        for subtask, found in zip(self._chain, chain, strict=True):
            if found.grasped != subtask.grasped:  # its script takes the one it was written for
                raise Refused(f"{subtask.id} is not feasible with {subtask.grasped} in the hand")
        return Layout(poses, {subtask.id: subtask.grasps for subtask in chain}, slots)

    def _require_described(self, poses: Mapping[str, Pose], boxes: Mapping[str, np.ndarray]) -> None:
        """Refuse poses and boxes (2, 3) that break a description or relation, or that make a goal true at the start."""
        if false := complaints(self._scene, [o.moved(poses[o.id]) for o in self._objects.values()]):
            raise Refused(false[0])
        if broken := self._broken(boxes):
            raise Refused(f"not {broken[0]}")
        if fulfilled := self._fulfilled(poses) - self._fulfilled_before:
            raise Refused(f"{min(map(str, fulfilled))} already")

    def _boxes(self, poses: Mapping[str, Pose]) -> dict[str, np.ndarray]:
        """(2, 3) axis-aligned box of every object, by id, metres."""
        return {name: world_aabb(o.asset.bounds, poses[name]) for name, o in self._objects.items()}

    def _broken(self, boxes: Mapping[str, np.ndarray]) -> list[str]:
        """The relations that do not hold between these boxes, in words."""
        return relations_kept(self._relations, boxes, self._on).sentences

    def _fulfilled(self, poses: Mapping[str, Pose]) -> set[Goal]:
        """Goals of the chain about how things stand that are true where objects have these poses."""
        state = StillState({name: o.moved(poses[name]) for name, o in self._objects.items()})
        goals = (goal for goal in self._goals if goal.kind.may_hold_already)
        placed = (goal for goal in goals if goal.reference != TABLE and goal.part is None)
        return {goal for goal in placed if goals_hold([goal], state).success}

    def _solved(self, rng: np.random.Generator) -> dict[str, Pose]:
        """The layout that keeps the plan and is nearest to a random one."""
        upright = least_costly(
            (self._random_poses(rng) for _ in range(LIMITS.compared_starts)),
            cost=lambda poses: len(self._broken(self._boxes(self._with_contents(poses)))),
        )
        targets = Targets(self._with_contents(upright), self._inside, self._relations)
        options = LayoutOptions(margin=self._margin, restarts=SETTINGS.restarts)
        found = nearest_layout(self._scene, targets, lambda: rng, options, self._context)
        solved = {name: Pose([*found.positions[name][:2], pose.p[2]], pose.q) for name, pose in upright.items()}
        return self._with_contents(solved)

    def _random_poses(self, rng: np.random.Generator) -> dict[str, Pose]:
        """Poses of the objects on the table, drawn at random within reach; of one arm where one must reach several."""
        some = {item.id: item for item in self._standing}
        for choices in self._for_one_arm:
            some |= {item.id: item for item in choices[rng.integers(len(choices))]}
        try:
            drawn = place(list(some.values()), self._workspace, rng, self._margin, relations=self._between)
        except InfeasibleScene:
            if not self._for_one_arm:
                raise
            drawn = place(self._standing, self._workspace, rng, self._margin, relations=self._between)
        return {item.id: item.pose(drawn[item.id], self._objects[item.id].pose.p[2]) for item in self._standing}

    def _poses_of_clutter(
        self, clutter: Sequence[SceneObject], boxes: Mapping[str, np.ndarray], rng: np.random.Generator
    ) -> dict[str, Pose]:
        """Poses of as many of the clutter as have room beside objects with these boxes (2, 3), the first ones."""
        taken = [self._kept_free(self._objects[name], box[:, :2]) for name, box in boxes.items()]
        items = [table_item(o.id, o.asset) for o in clutter]

        def placed(some: Sequence[TableItem]) -> dict[str, Pose]:
            spots = place(some, self._workspace, rng, SETTINGS.clutter_gap_m, taken) if some else {}
            return {item.id: item.pose(spots[item.id], self._scene.table.height) for item in some}

        fewer = (partial(placed, items[:count]) for count in range(len(items), -1, -1))
        return first_accepted(fewer, InfeasibleScene).value

    def _kept_free(self, o: SceneObject, rectangle: np.ndarray) -> np.ndarray:
        """(2, 2) rectangle of the table around an object; wider for a moved one, as a hand comes down on it."""
        gap = hand_clearance(self._robot).gap if o.record.role == "content" else 0.0
        return rectangle + [[-gap], [gap]]

    def _with_contents(self, upright: dict[str, Pose]) -> dict[str, Pose]:
        """Poses of all objects for these of the objects on the table; contents lie as they had settled."""
        found = {}
        for name, o in self._objects.items():
            root = self._root(name)
            stood = self._objects[root].pose
            found[name] = upright[root] * Pose.from_yaw(stood.p, stood.yaw).inverse() * o.pose
        return found

    def _root(self, name: str) -> str:
        return self._root(self._inside[name]) if name in self._inside else name

    def _headings(self, o: SceneObject) -> tuple[float, ...]:
        """Headings to draw from: any, except for an object with a front or contents, or that must end at a heading."""
        if o.asset.articulated:
            return FRONT_YAWS
        if o.record.role == "receptacle":
            return tuple(o.pose.yaw + turn for turn in SETTINGS.turns_rad)
        asked = [FACING[goal.relation] for goal in self._goals if goal.subject == o.id and goal.relation in FACING]
        most = SETTINGS.most_turned_rad + 1e-6
        return tuple(yaw for yaw in ANY_YAW if all(abs(wrap_angle(yaw - end)) < most for end in asked))

    def _examined(self, subtask: Subtask, workplace: Workplace) -> Subtask:
        found = examined(subtask, workplace)
        if found is None:
            raise Refused(f"{subtask.id} is not feasible")
        return found
