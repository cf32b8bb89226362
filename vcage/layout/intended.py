"""The intended layout of a plan: shown by a target picture, with the plan for everything out of view.

Starting places (:mod:`vcage.layout.starts`) are the targets of the layout's optimisation, which repairs remaining
violations. Where the plan cannot be kept so, room for hands, wide gaps and headings are given up in turn.
"""

from __future__ import annotations

import itertools
import logging
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from vcage.base.attempts import least_costly
from vcage.base.errors import InfeasibleScene
from vcage.base.geometry import Pose, rotation_2d, wrap_angle
from vcage.layout.groups import fits_opening
from vcage.layout.items import ANY_YAW, TableItem, hand_clearance
from vcage.layout.optimize import LayoutOptions, optimize_layout
from vcage.layout.starts import SETTINGS as STARTS
from vcage.layout.starts import starting_places
from vcage.layout.stowed import with_places, with_stowed
from vcage.objects.openings import Opening
from vcage.plans.kept import Kept, relations_kept
from vcage.plans.relations import ground_box, plane_gap
from vcage.schema.plan import TABLE, Relation
from vcage.schema.scene import Scene
from vcage.sim.robots import load_robot

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class IntendedSettings:
    """Settings of the layout that a picture is to show.

    Args:
        elongated: ratio of length to width of long objects: they are laid pointing away from the robot.
        restarts: of the optimisation besides the targets: these are good already, and there are other efforts.
        touch_m: overlap of two rectangles that still counts as touching.
    """

    elongated: float = 1.5
    restarts: int = 2
    touch_m: float = 1e-6


SETTINGS = IntendedSettings()


@dataclass(frozen=True)
class Effort:
    """Demands of an attempt beyond the plan.

    Args:
        gap: between any two objects, metres.
        turned: True if receptacles face the robot and long objects point away from it.
        hands: True if hands have room between grasped objects and high ones.
    """

    gap: float
    turned: bool
    hands: bool


EFFORTS = (
    Effort(STARTS.gap_m, True, True),
    Effort(STARTS.gap_m / 2, True, False),
    Effort(0.005, True, False),
    Effort(0.005, False, False),
)
"""Efforts that are tried in turn until the plan is kept."""


@dataclass(frozen=True)
class IntendedLayout:
    """The poses that a plan wants.

    Args:
        poses: in the world, by object id.
        boxes: (2, 3) world boxes, by object id; none for the contents of moving parts.
        kept: how much of the plan that keeps.
        overlapping: ids of objects on the table that overlap another for want of room.
    """

    poses: dict[str, Pose]
    boxes: dict[str, np.ndarray]
    kept: Kept
    overlapping: list[str]


def intended_layout(
    scene: Scene,
    relations: Sequence[Relation],
    items: Mapping[str, TableItem],
    fixed: Mapping[str, Pose] | None = None,
) -> IntendedLayout:
    """A pose for every object of a scene: the plan's relations first, no overlap, in the workspace and in view.

    Where relations and free space conflict, relations give way, so no object is ever lost. Where there is no
    free space left, objects overlap, and a warning names them. Contents move with their container if they lie there at
    the start and by the plan, and so do contents of a moving part; objects only planned there are laid out in its
    opening. The same input gives the same layout.

    Args:
        scene: where the objects stand now.
        relations: of the plan; those that name unknown objects are skipped.
        items: geometry of every object, by id; an object without an opening holds its planned contents on its surface.
        fixed: objects with a known place.
    """
    items = {name: item for name, item in items.items() if name in with_places(scene)}
    known = [r for r in relations if r.subject in items and r.reference in (*items, TABLE)]
    search = _Search(scene, known, items, fixed or {})
    best = least_costly(
        map(search.attempt, EFFORTS), cost=lambda found: (len(found.overlapping), len(found.kept.broken)), enough=(0, 0)
    )
    if best.overlapping:
        logger.warning("no room to keep these apart: %s", ", ".join(best.overlapping))
    return best


class _Search:
    """The attempts at one plan."""

    def __init__(
        self,
        scene: Scene,
        relations: Sequence[Relation],
        items: Mapping[str, TableItem],
        fixed: Mapping[str, Pose],
    ):
        self._scene, self._relations = scene, relations
        self._fixed = {name: pose for name, pose in fixed.items() if name in items}
        self._hand = hand_clearance(load_robot(scene.robot))
        self._supports = supports_of(r for r in relations if r.subject not in self._fixed)
        self._items = dict(items)
        for r in relations:
            if self._supports.get(r.subject) == r.reference:
                self._items[r.reference] = _with_surface(items[r.reference], hollow=r.relation == "inside")
        self._workspace = np.array([scene.workspace.lower, scene.workspace.upper])
        # Contents are at the place of their container.
        carriers = [(self._root(r.subject), r.relation, self._root(r.reference)) for r in relations]
        self._between = [
            Relation(subject=a, relation=word, reference=b)
            for a, word, b in carriers
            if a != b and word not in ("inside", "on")
        ]

    def _root(self, name: str) -> str:
        return self._root(self._supports[name]) if name in self._supports else name

    def attempt(self, effort: Effort) -> IntendedLayout:
        """The layout found with this effort; where there is none, the targets themselves, with overlaps."""
        items = self._with_targets(effort)
        try:
            positions = optimize_layout(
                items,
                self._workspace,
                self._scene.table,
                np.random.default_rng(0),
                self._relations,
                LayoutOptions(margin=effort.gap, restarts=SETTINGS.restarts),
            ).positions
        except InfeasibleScene as error:
            logger.debug("no layout with %s: %s", effort, error.message)
            positions = {item.id: (*item.target, self._scene.table.height + self._lift(item.id)) for item in items}
        poses = {item.id: Pose.from_yaw(positions[item.id], item.yaw) for item in items}
        boxes = {item.id: _box(item, poses[item.id]) for item in items}
        standing = [name for name in boxes if name not in self._supports]
        clashes = [
            (a, b)
            for a, b in itertools.combinations(standing, 2)
            if plane_gap(boxes[a], boxes[b]) < -SETTINGS.touch_m and not (a in self._fixed and b in self._fixed)
        ]
        overlapping = [name for name in standing if any(name in pair for pair in clashes)]
        ground = ground_box(self._scene.workspace, self._scene.table.height)
        kept = relations_kept(self._relations, boxes, ground)
        return IntendedLayout(with_stowed(self._scene, poses), boxes, kept, overlapping)

    def _lift(self, name: str) -> float:
        holder = self._supports.get(name)
        return 0.0 if holder is None else self._items[holder].room.floor + self._lift(holder)

    def _with_targets(self, effort: Effort) -> list[TableItem]:
        """All objects at their headings, where they should be."""
        standing = [self._headed(name, effort) for name in self._items if name not in self._supports]
        found = {item.id: item for item in starting_places(self._scene, standing, self._between, effort.gap)}
        while len(found) < len(self._items):
            for name, holder in self._supports.items():
                if holder in found and name not in found:
                    found[name] = self._carried(self._items[name], found[holder])
                    found[holder] = _widened(found[holder], found[name])
        return [found[name] for name in self._items]

    def _headed(self, name: str, effort: Effort) -> TableItem:
        """The item of an object on the table, at its heading and where it stands now."""
        item, record = self._items[name], self._scene.object(name)
        pose = self._fixed.get(name, record.pose.pose())
        yaw = pose.yaw
        if effort.turned and name not in self._fixed:
            yaw = _heading(item, record.role, yaw)
        return replace(
            item,
            yaws=(yaw,),
            target=(float(pose.p[0]), float(pose.p[1])),
            hand=self._hand if effort.hands and record.role == "content" else None,
            fixed=name in self._fixed,
            inside=None,
            allowed=None,
        )

    def _carried(self, item: TableItem, holder: TableItem) -> TableItem:
        """The item of an object in or on another: at its present place there, or in the middle of the opening."""
        record, below = self._scene.object(item.id), self._scene.object(holder.id)
        pose, carrier = record.pose.pose(), below.pose.pose()
        turn = holder.yaw - carrier.yaw
        if record.container == holder.id:
            way = rotation_2d(turn) @ (pose.p - carrier.p)[:2]
            yaw = float(wrap_angle(pose.yaw + turn))
        else:
            headings = (pose.yaw, holder.yaw, holder.yaw + np.pi / 2)
            yaw = next((y for y in headings if fits_opening(replace(item, yaws=(y,)), holder)), pose.yaw)
            way = rotation_2d(holder.yaw) @ np.array(holder.room.centre) - rotation_2d(yaw) @ np.array(item.centre)
        target = (float(holder.target[0] + way[0]), float(holder.target[1] + way[1]))
        return replace(item, yaws=(yaw,), target=target, inside=holder.id, allowed=None)


def _heading(item: TableItem, role: str, yaw: float) -> float:
    """Receptacles face the robot, and so does what has moving parts; long things point away from it."""
    if role == "receptacle":
        return 0.0
    width, depth = item.body_size[:2]
    if item.yaws != ANY_YAW or max(width, depth) <= SETTINGS.elongated * min(width, depth):
        return yaw
    axis = yaw if width >= depth else yaw + np.pi / 2
    return float(wrap_angle(yaw + (np.pi - axis) % np.pi - np.pi / 2))


def supports_of(relations: Iterable[Relation]) -> dict[str, str]:
    """Holder of each object by the plan, without circles: the first that the plan names counts."""
    found: dict[str, str] = {}
    for r in relations:
        if r.relation in ("inside", "on") and r.reference != TABLE and r.subject not in found:
            above, at = [r.subject], r.reference
            while at in found:
                above.append(at)
                at = found[at]
            if at not in above:
                found[r.subject] = r.reference
    return found


def _widened(holder: TableItem, content: TableItem) -> TableItem:
    """The holder with an opening that accepts the content where it is; the true fit is checked elsewhere."""
    turn = rotation_2d(-holder.yaw)
    rectangle = content.rectangle(holder.yaw) + turn @ np.subtract(content.target, holder.target)
    centre, half = np.array(holder.room.centre), np.array(holder.room.size) / 2
    width, depth = (2 * np.maximum(half, np.abs(rectangle - centre).max(axis=0))).tolist()
    return replace(holder, opening=replace(holder.room, size=(width, depth)))


def _with_surface(item: TableItem, hollow: bool) -> TableItem:
    """The item with an opening as large as itself, if it has none; no rim is too low for its contents."""
    if item.opening is not None:
        return replace(item, opening=replace(item.opening, rim=np.inf))
    width, depth = (float(side) for side in item.body_size[:2])
    x, y = item.centre if item.body is None else np.mean(np.asarray(item.body, dtype=np.float64), axis=0).tolist()
    return replace(item, opening=Opening((x, y), (width, depth), 0.0 if hollow else item.size[2], np.inf))


def _box(item: TableItem, pose: Pose) -> np.ndarray:
    """(2, 3) world box of an item at a pose."""
    return np.column_stack([item.body_rectangle() + pose.p[:2], pose.p[2] + np.array([0.0, item.size[2]])])
